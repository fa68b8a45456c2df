// What the motion model uses of nav2_mppi_controller (1.5, Lyrical), with the arrays of Eigen.
#ifndef STUB_MOTION_MODELS_HPP
#define STUB_MOTION_MODELS_HPP

#include <cstddef>
#include <vector>

namespace Eigen {

using Index = std::ptrdiff_t;

class ArrayXf {
public:
    explicit ArrayXf(Index size = 0) : values_(static_cast<std::size_t>(size)) {}
    Index size() const { return static_cast<Index>(values_.size()); }
    float &operator()(Index k) { return values_.at(static_cast<std::size_t>(k)); }

private:
    std::vector<float> values_;
};

class ArrayXXf {
public:
    explicit ArrayXXf(Index rows = 0, Index columns = 0) : rows_(rows), columns_(columns), values_(rows * columns) {}
    Index rows() const { return rows_; }
    Index cols() const { return columns_; }
    float &operator()(Index row, Index column) { return values_(row + rows_ * column); }

private:
    Index rows_, columns_;
    ArrayXf values_;
};

} // namespace Eigen

namespace mppi {

namespace models {

struct ControlSequence {
    Eigen::ArrayXf vx, vy, wz;
};

struct State {
    Eigen::ArrayXXf vx, vy, wz, cvx, cvy, cwz;
};

} // namespace models

class MotionModel {
public:
    virtual ~MotionModel() = default;

    // Without limits of acceleration: a command has its effect in the next step.
    virtual void predict(models::State &state)
    {
        for (Eigen::Index column = 1; column < state.vx.cols(); ++column) {
            for (Eigen::Index row = 0; row < state.vx.rows(); ++row) {
                state.vx(row, column) = state.cvx(row, column - 1);
                state.wz(row, column) = state.cwz(row, column - 1);
                if (isHolonomic()) {
                    state.vy(row, column) = state.cvy(row, column - 1);
                }
            }
        }
    }
    virtual bool isHolonomic() const = 0;
    virtual void applyConstraints(models::ControlSequence & /*control_sequence*/) {}
};

} // namespace mppi

#endif
