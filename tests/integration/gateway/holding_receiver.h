// A receiver of webhooks that takes its time.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <string>
#include <vector>

namespace mortise::gateway {

// Takes webhooks' posts and answers them when the test says so.
class HoldingReceiver {
 public:
  HoldingReceiver() : acceptor_(io_, {boost::asio::ip::make_address("127.0.0.1"), 0}) {}

  std::string url() const {
    return "http://127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port()) + "/";
  }

  // Waits for so many posts.
  void Take(int count) {
    for (int i = 0; i < count; ++i) {
      held_.push_back(acceptor_.accept());
      boost::beast::flat_buffer buffer;
      boost::beast::http::request<boost::beast::http::string_body> request;
      boost::beast::http::read(held_.back(), buffer, request);
    }
  }

  void Answer() {
    for (boost::asio::ip::tcp::socket& socket : held_) {
      boost::beast::http::response<boost::beast::http::empty_body> response(
          boost::beast::http::status::no_content, 11);
      boost::beast::http::write(socket, response);
    }
    held_.clear();
  }

 private:
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  std::vector<boost::asio::ip::tcp::socket> held_;
};

}  // namespace mortise::gateway
