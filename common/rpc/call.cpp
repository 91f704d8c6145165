#include "common/rpc/call.h"

#include "common/rpc/call_state.h"

namespace mortise::rpc {

const Identity& Call::identity() const { return state_->identity(); }
const std::string& Call::method() const { return state_->method().name; }
absl::Time Call::deadline() const { return state_->deadline(); }
bool Call::cancelled() const { return state_->cancelled(); }
void Call::OnStop(std::function<void()> callback) const { state_->OnStop(std::move(callback)); }
const std::string& Call::signed_identity() const { return state_->signed_identity(); }

}  // namespace mortise::rpc
