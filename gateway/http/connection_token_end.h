// The end of a stream at the HTTP door with its caller's token: see token_end.h.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/system_timer.hpp>
#include <memory>

#include "gateway/admission/admission.h"
#include "gateway/forwarding/awaitable.h"
#include "gateway/http/http_connection.h"

namespace mortise::gateway {

// Closes the connection when the time for its last words has passed.
class ConnectionTokenEnd {
 public:
  // On the connection's own strand, which is `strand`; the connection must outlive this.
  ConnectionTokenEnd(boost::asio::any_io_executor strand, HttpConnection& connection,
                     const Caller& caller);
  ~ConnectionTokenEnd();
  ConnectionTokenEnd(const ConnectionTokenEnd&) = delete;
  ConnectionTokenEnd& operator=(const ConnectionTokenEnd&) = delete;

 private:
  boost::asio::system_timer timer_;
  const std::shared_ptr<bool> over_ = std::make_shared<bool>(false);
};

}  // namespace mortise::gateway
