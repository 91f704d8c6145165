// SI is the unit of every interface and file. These factors name the few other units that people
// type or read: 35 * kMillimetre is 0.035 (metres).
#pragma once

namespace mortise {

inline constexpr double kMillimetre = 1e-3;  // m
inline constexpr double kMegapascal = 1e6;   // Pa
inline constexpr double kGigapascal = 1e9;   // Pa
inline constexpr double kGravity = 9.80665;  // m/s², standard gravity

}  // namespace mortise
