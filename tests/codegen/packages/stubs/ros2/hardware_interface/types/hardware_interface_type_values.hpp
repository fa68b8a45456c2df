// What the controller uses of hardware_interface (Kilted).
#ifndef STUB_HARDWARE_INTERFACE_TYPE_VALUES_HPP
#define STUB_HARDWARE_INTERFACE_TYPE_VALUES_HPP

namespace hardware_interface {
constexpr char HW_IF_POSITION[] = "position";
constexpr char HW_IF_VELOCITY[] = "velocity";
} // namespace hardware_interface

#endif
