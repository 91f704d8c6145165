// Services that answer as tests ask them to, for a gateway to stand in front of.
#pragma once

#include <grpcpp/server.h>

#include <atomic>
#include <memory>
#include <string>

namespace mortise::gateway {

// One server that is the catalog, the simulator and the fabplanner.
//
// GetItem by name: "items/echo" describes the call (title: the metadata x-custom; supplier: the
// request id; supplier_number: whether an identity or trace came; supplier_url: whether a token
// came, which must not); "items/missing" is NOT_FOUND with details; "items/slow" answers when the
// call is cancelled; others answer with their name.
// ExportDesign: `revision` bytes in chunks of 256 KiB; a name "templates/broken" fails after the
// first chunk, "templates/endless" goes on until cancelled.
// UploadBlob answers with the number of bytes. AttachBridge answers each hello with a hold of its
// name, after a first hold "welcome" that waits for nothing.
class FakeHouse {
 public:
  FakeHouse();
  ~FakeHouse();

  const std::string& address() const { return address_; }

  // How many calls saw their cancellation, and how many messages streams have written.
  int cancelled() const { return cancelled_; }
  int64_t written() const { return written_; }

  // Waits until `cancelled()` reaches `count`; false after ten seconds.
  bool WaitForCancelled(int count) const;

 private:
  struct Services;
  std::atomic<int> cancelled_{0};
  std::atomic<int64_t> written_{0};
  std::unique_ptr<Services> services_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
};

}  // namespace mortise::gateway
