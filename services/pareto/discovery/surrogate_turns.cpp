#include "services/pareto/discovery/surrogate_turns.h"

#include <algorithm>

namespace mortise::pareto {
namespace {

constexpr double kMost = 0.4;    // of the evaluations
constexpr double kLeast = 0.05;  // the same

// What is remembered: so many evaluations, and so many more for each parameter, which local models
// need before they gain anything.
constexpr double kMemory = 20;
constexpr double kMemoryOfParameter = 2;
constexpr double kUnproven = 0.2;  // of the memory: evaluations that both ways begin with, as good

// The share of predictions within two deviations from which on foretelling earns all turns, and
// that up to which it earns none; before the first are told it counts as if so many had been good.
constexpr double kTrusted = 0.85;
constexpr double kDistrusted = 0.6;
constexpr double kTrustedBefore = 10;

}  // namespace

SurrogateTurns::SurrogateTurns(Eigen::Index size, std::optional<double> fixed)
    : fixed_(fixed), memory_(kMemory + kMemoryOfParameter * static_cast<double>(size)) {}

void SurrogateTurns::Count(bool is_surrogates, double gain) {
  const double kept = 1 - 1 / memory_;
  for (Earned* each : {&surrogate_, &others_}) {
    each->gain *= kept;
    each->evaluations *= kept;
  }
  Earned& earned = is_surrogates ? surrogate_ : others_;
  earned.gain += gain;
  ++earned.evaluations;
}

void SurrogateTurns::Propose(bool is_surrogates, const SurrogateQuality& foretold) {
  balance_ += Share(foretold) - (is_surrogates ? 1 : 0);
}

double SurrogateTurns::Share(const SurrogateQuality& foretold) const {
  return fixed_.value_or(std::max(kLeast, kMost * Trust(foretold) * Lead()));
}

double SurrogateTurns::Trust(const SurrogateQuality& foretold) const {
  const auto told = static_cast<double>(foretold.predictions);
  const double within =
      (told * foretold.within_two_deviations + kTrustedBefore * kTrusted) / (told + kTrustedBefore);
  return std::clamp((within - kDistrusted) / (kTrusted - kDistrusted), 0.0, 1.0);
}

double SurrogateTurns::Lead() const {
  const double unproven = kUnproven * memory_;
  const double all = surrogate_.evaluations + others_.evaluations;
  const double mean = all > 0 ? (surrogate_.gain + others_.gain) / all : 0;
  const auto rate = [&](const Earned& earned) {
    return (earned.gain + unproven * mean) / (earned.evaluations + unproven);
  };
  const double others = rate(others_);
  return others > 0 ? std::min(1.0, rate(surrogate_) / others) : 1;
}

}  // namespace mortise::pareto
