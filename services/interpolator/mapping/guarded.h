// Catches what libraries throw (CGAL, OpenMesh, Eigen) where they are called, and where work runs
// on threads on which nothing else does.
#pragma once

#include <exception>
#include <new>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace mortise::interpolator {

// Returns what `work` returns, a status or a value or status. RESOURCE_EXHAUSTED where it runs out
// of memory; INTERNAL with what it says where it throws anything else.
template <typename Work>
auto Guarded(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("there is too little memory");
  } catch (const std::exception& exception) {
    return absl::InternalError(absl::StrCat("an exception: ", exception.what()));
  } catch (...) {
    return absl::InternalError("an exception");
  }
}

}  // namespace mortise::interpolator
