// What the controller uses of pluginlib: the class must derive from its base, and must have a default constructor.
#ifndef STUB_CLASS_LIST_MACROS_HPP
#define STUB_CLASS_LIST_MACROS_HPP

#include <memory>
#include <type_traits>

#define PLUGINLIB_EXPORT_CLASS(class_type, base_class_type)                                          \
    static_assert(std::is_base_of_v<base_class_type, class_type>, "the plugin is no " #base_class_type); \
    static_assert(std::is_default_constructible_v<class_type>, "the plugin has no default constructor");

#endif
