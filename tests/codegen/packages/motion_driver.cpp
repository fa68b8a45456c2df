// Reads twists (VX VY OMEGA a line) and prints, for each, the twist that the motion model makes of it: alone, in a sequence
// of controls, and in the prediction of a sample. The first line is whether MPPI uses vy.
#include <cstdio>
#include <iostream>

#include MODEL

int main()
{
    ROBOT::MotionModel model;
    std::vector<float> vx, vy, wz;
    for (float a, b, c; std::cin >> a >> b >> c;) {
        vx.push_back(a);
        vy.push_back(b);
        wz.push_back(c);
    }
    const auto count = static_cast<Eigen::Index>(vx.size());
    mppi::models::ControlSequence sequence{ Eigen::ArrayXf(count), Eigen::ArrayXf(count), Eigen::ArrayXf(count) };
    const Eigen::ArrayXXf samples(1, count + 1);
    mppi::models::State state{ samples, samples, samples, samples, samples, samples };
    for (Eigen::Index k = 0; k < count; ++k) {
        const auto place = static_cast<std::size_t>(k);
        sequence.vx(k) = state.cvx(0, k) = vx[place];
        sequence.vy(k) = state.cvy(0, k) = vy[place];
        sequence.wz(k) = state.cwz(0, k) = wz[place];
    }
    model.applyConstraints(sequence);
    model.predict(state);
    std::printf("%d\n", model.isHolonomic() ? 1 : 0);
    for (Eigen::Index k = 0; k < count; ++k) {
        const auto place = static_cast<std::size_t>(k);
        const auto twist = model.drivable(vx[place], vy[place], wz[place]);
        std::printf("%.9g %.9g %.9g ", static_cast<double>(twist.vx), static_cast<double>(twist.vy),
                    static_cast<double>(twist.omega));
        std::printf("%.9g %.9g %.9g ", static_cast<double>(sequence.vx(k)), static_cast<double>(sequence.vy(k)),
                    static_cast<double>(sequence.wz(k)));
        std::printf("%.9g %.9g %.9g\n", static_cast<double>(state.vx(0, k + 1)), static_cast<double>(state.vy(0, k + 1)),
                    static_cast<double>(state.wz(0, k + 1)));
    }
}
