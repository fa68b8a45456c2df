// What WPILib and wmrgen need for the same call: program FUNCTION CALLS runs it CALLS (up to 4000) times on changing inputs.
#include <cstdlib>
#include <map>
#include <string>

#include <frc/kinematics/DifferentialDriveKinematics.h>
#include <frc/kinematics/MecanumDriveKinematics.h>
#include <frc/kinematics/SwerveDriveKinematics.h>

extern "C" {
#include "clearpath_do100.h"
#include "textbook_differential.h"
#include "wpilib_swervebot.h"
}

namespace {
// Every member of a result has to be there.
template <class T> void keep(const T &result) { __asm__ volatile("" : : "m"(result) : "memory"); }


double doubles[8192];
float floats[8192];

double input(int k) { return doubles[k]; }
float at(int k) { return floats[k]; }

frc::ChassisSpeeds twist(int k)
{
    return {units::meters_per_second_t{input(k)}, units::meters_per_second_t{input(k + 333)},
            units::radians_per_second_t{input(k + 700)}};
}

const frc::DifferentialDriveKinematics differential{units::meter_t{1.2}};
frc::MecanumDriveKinematics mecanum{frc::Translation2d{0.25_m, 0.2454_m}, frc::Translation2d{0.25_m, -0.2454_m},
                                    frc::Translation2d{-0.25_m, 0.2454_m}, frc::Translation2d{-0.25_m, -0.2454_m}};
frc::SwerveDriveKinematics<4> swerve{frc::Translation2d{0.381_m, 0.381_m}, frc::Translation2d{0.381_m, -0.381_m},
                                     frc::Translation2d{-0.381_m, 0.381_m}, frc::Translation2d{-0.381_m, -0.381_m}};

void wpilib_differential_inverse(int k) { keep(differential.ToWheelSpeeds(twist(k))); }

void wpilib_differential_forward(int k)
{
    const frc::DifferentialDriveWheelSpeeds speeds{units::meters_per_second_t{input(k)},
                                                   units::meters_per_second_t{input(k + 5)}};
    keep(differential.ToChassisSpeeds(speeds));
}

void wpilib_mecanum_inverse(int k) { keep(mecanum.ToWheelSpeeds(twist(k))); }

void wpilib_mecanum_forward(int k)
{
    const frc::MecanumDriveWheelSpeeds speeds{
        units::meters_per_second_t{input(k)}, units::meters_per_second_t{input(k + 5)},
        units::meters_per_second_t{input(k + 77)}, units::meters_per_second_t{input(k + 99)}};
    keep(mecanum.ToChassisSpeeds(speeds));
}

void wpilib_swerve_inverse(int k)
{
    auto states = swerve.ToSwerveModuleStates(twist(k));
    for (auto &state : states) {
        state.Optimize(frc::Rotation2d{units::radian_t{input(k + 50)}});
    }
    keep(states);
}

void wpilib_swerve_forward(int k)
{
    wpi::array<frc::SwerveModuleState, 4> states{wpi::empty_array};
    for (int i = 0; i < 4; i++) {
        states[i] = {units::meters_per_second_t{input(k + i)}, frc::Rotation2d{units::radian_t{input(k + 9 * i)}}};
    }
    keep(swerve.ToChassisSpeeds(states));
}

void wmrgen_differential_inverse(int k)
{
    const textbook_differential_twist in = {at(k), at(k + 333), at(k + 700)};
    textbook_differential_wheels out;
    textbook_differential_inverse(&in, &out);
    keep(out);
}

void wmrgen_differential_forward(int k)
{
    textbook_differential_wheels in;
    in.left.spin = at(k);
    in.right.spin = at(k + 5);
    textbook_differential_twist out;
    textbook_differential_forward(&in, &out);
    keep(out);
}

void wmrgen_mecanum_inverse(int k)
{
    const clearpath_do100_twist in = {at(k), at(k + 333), at(k + 700)};
    clearpath_do100_wheels out;
    clearpath_do100_inverse(&in, &out);
    keep(out);
}

void wmrgen_mecanum_forward(int k)
{
    clearpath_do100_wheels in;
    in.front_left.spin = at(k);
    in.front_right.spin = at(k + 5);
    in.rear_left.spin = at(k + 77);
    in.rear_right.spin = at(k + 99);
    clearpath_do100_twist out;
    clearpath_do100_forward(&in, &out);
    keep(out);
}

void wmrgen_swerve_inverse(int k)
{
    const wpilib_swervebot_twist in = {at(k), at(k + 333), at(k + 700)};
    wpilib_swervebot_wheels now;
    now.front_left.steer = now.front_right.steer = now.back_left.steer = now.back_right.steer = at(k + 50);
    wpilib_swervebot_wheels out;
    wpilib_swervebot_inverse(&in, &now, &out);
    keep(out);
}

void wmrgen_swerve_forward(int k)
{
    wpilib_swervebot_wheels in;
    in.front_left = {at(k), at(k)};
    in.front_right = {at(k + 1), at(k + 9)};
    in.back_left = {at(k + 2), at(k + 18)};
    in.back_right = {at(k + 3), at(k + 27)};
    wpilib_swervebot_twist out;
    wpilib_swervebot_forward(&in, &out);
    keep(out);
}

const std::map<std::string, void (*)(int)> functions{
    {"wpilib_differential_inverse", wpilib_differential_inverse},
    {"wpilib_differential_forward", wpilib_differential_forward},
    {"wpilib_mecanum_inverse", wpilib_mecanum_inverse},
    {"wpilib_mecanum_forward", wpilib_mecanum_forward},
    {"wpilib_swerve_inverse", wpilib_swerve_inverse},
    {"wpilib_swerve_forward", wpilib_swerve_forward},
    {"wmrgen_differential_inverse", wmrgen_differential_inverse},
    {"wmrgen_differential_forward", wmrgen_differential_forward},
    {"wmrgen_mecanum_inverse", wmrgen_mecanum_inverse},
    {"wmrgen_mecanum_forward", wmrgen_mecanum_forward},
    {"wmrgen_swerve_inverse", wmrgen_swerve_inverse},
    {"wmrgen_swerve_forward", wmrgen_swerve_forward},
};
} // namespace

int main(int, char **words)
{
    for (int k = 0; k < 8192; k++) {
        doubles[k] = 0.003 * (k * 389 % 2000) - 3.0;
        floats[k] = static_cast<float>(doubles[k]);
    }
    const auto function = functions.at(words[1]);
    for (int k = std::atoi(words[2]); k > 0; k--) {
        function(k);
    }
    return 0;
}
