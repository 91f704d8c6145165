// Where the public keys of bearer tokens come from.
#pragma once

#include <memory>

#include "gateway/contract/token.h"

namespace mortise::gateway {

// Thread safe, and never waits.
class KeySource {
 public:
  virtual ~KeySource() = default;

  // Returns the keys there are now; null as long as there were never any. The same object until
  // they change, which is how somebody who remembers tokens knows that they do.
  virtual std::shared_ptr<const TokenKeys> keys() const = 0;

  // Somebody shows a token of a key that is not among them. Returns whether the keys are being
  // fetched anew; false if that was tried a moment ago, or if they never change.
  virtual bool FetchAnew() = 0;
};

// Keys that never change.
class FixedKeys final : public KeySource {
 public:
  explicit FixedKeys(TokenKeys keys) : keys_(std::make_shared<const TokenKeys>(std::move(keys))) {}
  std::shared_ptr<const TokenKeys> keys() const override { return keys_; }
  bool FetchAnew() override { return false; }

 private:
  const std::shared_ptr<const TokenKeys> keys_;
};

}  // namespace mortise::gateway
