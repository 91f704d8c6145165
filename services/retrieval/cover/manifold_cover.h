// Covers a manifold in descriptor space with points and bounded tangent spaces, so that a distance
// from the manifold can be answered without evaluating a design (thesis §4.3.1, §4.4).
//
// The method is the thesis's, by rejection: points of the feasible set are drawn and evaluated; one
// that lies further than δ from all primitives becomes the centre of a new one; after enough
// rejections in a row the cover is done. What the thesis leaves open, and where we go further:
//
// - Descriptors ignore size, so the Jacobian loses rank. Tangent spaces have its numerical rank r:
//   directions in which the whole feasible set moves a descriptor by less than δ/10 do not count
//   (tangent_frame.h).
// - A tangent primitive may have fewer axes than r: the number m of axes whose product of radii, in
//   units of δ, over m + 1 is largest, as (4.6) compares m = r with m = 0 alone. Where a manifold
//   is flat in one direction and curved in another, an axis along the first is what pays.
// - Radii are measured, not only predicted: the manifold is evaluated where an axis ends and at
//   places between the axes, and a radius shrinks until each of those places lies within 0.9 δ of
//   an evaluated point (tangent_fit.h).
// - Points alone and tangents alone are covers of the same samples, nearly for free. They race with
//   the mixture, and the cheapest that gets done is the answer: the mixture never costs more than
//   either.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/manifold.h"
#include "services/retrieval/cover/primitive.h"

namespace mortise::retrieval {

// Which primitives a cover may have.
enum class CoverKind {
  kMixed,     // whichever is cheaper where it stands
  kPoints,    // for comparison (Figure 4-9)
  kTangents,  // for comparison: all r axes everywhere
};

// How far a cover has come.
struct CoverProgress {
  long evaluations = 0;  // of the manifold, for samples, differences and radii
  int primitives = 0;    // of the kind that was asked for
  int rejections = 0;    // in a row, of CoverOptions::rejections
};

struct CoverOptions {
  double delta = 0;  // the largest error of a distance, > 0, in distances between descriptors
  std::uint64_t seed = 0;
  // The cover is done when so many samples in a row are covered. With n, the part that is not
  // covered is less than 3 / n with 95 % confidence: 2000 stands for 0.15 %, 300 for 1 %.
  int rejections = 2000;
  CoverKind kind = CoverKind::kMixed;
  // Whether a mixed cover races with the single kinds. It costs the derivatives of tangents where
  // the mixture has points.
  bool race = true;
  int most_primitives = 100'000;
  long most_evaluations = 1'000'000;
  int threads = 1;            // the same cover with any number
  std::stop_token stop = {};  // CANCELLED, before the next sample
  std::function<void(const CoverProgress&)> progress = nullptr;  // told after each batch
};

// Why a cover has no more primitives.
enum class CoverEnd { kCovered, kPrimitiveLimit, kEvaluationLimit };

struct Cover {
  std::vector<Primitive> primitives;          // in the order in which they were found
  CoverKind kind = CoverKind::kMixed;         // what won the race
  CoverEnd end = CoverEnd::kCovered;          // anything else: parts are not covered
  long cost = 0;                              // sum of Cost(primitive)
  long samples = 0;                           // drawn, with those that could not be evaluated
  long evaluations = 0;                       // all, failures with them
  long failures = 0;                          // designs that could not be evaluated
  std::vector<std::string> failure_messages;  // what the first of them said, ten at most
  // What 95 of 100 designs are no further from what the cover was made of than: 0 where that is the
  // designs themselves.
  double interpolation_error = 0;
};

// Covers a manifold. The same seed gives the same bits with any number of threads. A sample that
// cannot be evaluated is counted and left out; a tangent that meets such designs ends before them.
//
// Memory: the primitives of the kinds that race. Work: one evaluation a sample; for a place where a
// tangent may pay two evaluations a parameter; for a tangent with m axes 2 m to 8 m for its radii
// and, with two axes and more, 4 m to 8 m for each of at most six rounds between them.
//
// INVALID_ARGUMENT for options out of range; FAILED_PRECONDITION, FEASIBLE_SET_UNBOUNDED, or
// NOTHING_EVALUATED where each of the first `rejections` samples fails; CANCELLED; else what
// Sample fails with.
absl::StatusOr<Cover> CoverManifold(const Manifold& manifold, const CoverOptions& options);

}  // namespace mortise::retrieval
