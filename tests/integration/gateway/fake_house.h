// Services that answer as tests ask them to, for a gateway to stand in front of.
#pragma once

#include <grpcpp/server.h>

#include <condition_variable>
#include <memory>
#include <mutex>
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
// "templates/file" is a file of `revision` bytes of FileBytes(), as services send one, named and
// typed; "templates/page" the same as text/html with a name that is an attack; "templates/short"
// ends before what it said. ListItems has two pages of an item each; ImportCatalog creates what it
// is given, but for items/bad, whose price is at fault. UploadBlob answers with the number of bytes
// and the file's type and stated digest, refuses at once what is over 1 GiB, and takes nothing more
// after the first piece of the type "test/stall". AttachBridge answers each hello with a hold of
// its name, after a first hold "welcome" that waits for nothing. HoldWorkOrder answers at once.
class FakeHouse {
 public:
  // `most_streams` is how many calls one connection may have, as HTTP/2 counts; 0: any number.
  explicit FakeHouse(int most_streams = 0);
  ~FakeHouse();

  const std::string& address() const { return address_; }

  // The file of so many bytes.
  static std::string FileBytes(std::size_t count);

  struct Counts {
    int slow = 0;       // calls of items/slow that have begun
    int cancelled = 0;  // calls that saw their cancellation
    int written = 0;    // messages that streams have written
    int uploaded = 0;   // pieces of uploads that have come
  };
  Counts counts() const;

  // Waits until `count` calls of items/slow have begun, messages of streams been written, or calls
  // been cancelled; false after ten seconds.
  bool WaitForSlow(int count) { return WaitFor(&Counts::slow, count); }
  bool WaitForWritten(int count) { return WaitFor(&Counts::written, count); }
  bool WaitForUploaded(int count) { return WaitFor(&Counts::uploaded, count); }
  bool WaitForCancelled(int count) { return WaitFor(&Counts::cancelled, count); }

 private:
  struct Services;
  void Count(int Counts::*what);
  // Counts the call as cancelled once it is.
  void WaitUntilOver(const grpc::ServerContext& context);
  bool WaitFor(int Counts::*what, int count);

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Counts counts_;  // guarded by mutex_
  std::unique_ptr<Services> services_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
};

}  // namespace mortise::gateway
