#include "gateway/http/connection_token_end.h"

#include <boost/system/error_code.hpp>
#include <utility>

#include "gateway/forwarding/token_end.h"

namespace mortise::gateway {

ConnectionTokenEnd::ConnectionTokenEnd(boost::asio::any_io_executor strand,
                                       HttpConnection& connection, const Caller& caller)
    : timer_(std::move(strand)) {
  if (caller.expires_at == absl::InfiniteFuture()) return;
  timer_.expires_at(ExpiryOf(caller) + kLastWordsTime);
  timer_.async_wait([&connection, over = over_](const boost::system::error_code& error) {
    if (!error && !*over) connection.Close();
  });
}

ConnectionTokenEnd::~ConnectionTokenEnd() { *over_ = true; }

}  // namespace mortise::gateway
