// Owns what a library of C made.
#pragma once

namespace mortise {

// A deleter for std::unique_ptr: std::unique_ptr<EVP_PKEY, FreedBy<EVP_PKEY_free>>.
template <auto kFree>
struct FreedBy {
  template <class T>
  void operator()(T* pointer) const {
    kFree(pointer);
  }
};

}  // namespace mortise
