// A receiver of webhooks that answers at once, in plain text or with TLS.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "tests/unit/common/rpc/self_signed.h"

namespace mortise::gateway {

// Takes webhooks' posts and answers with what the test says.
class WebhookReceiver {
 public:
  struct Post {
    std::map<std::string, std::string> headers;
    std::string body;
  };

  WebhookReceiver() : acceptor_(io_, {boost::asio::ip::make_address("127.0.0.1"), 0}) { Begin(); }

  // With TLS, and this certificate.
  explicit WebhookReceiver(const mortise::testing::SelfSigned& own)
      : acceptor_(io_, {boost::asio::ip::make_address("127.0.0.1"), 0}),
        tls_(boost::asio::ssl::context::tls_server) {
    tls_->use_certificate_chain(boost::asio::buffer(own.certificate));
    tls_->use_private_key(boost::asio::buffer(own.key), boost::asio::ssl::context::pem);
    Begin();
  }

  ~WebhookReceiver() {
    stopping_ = true;
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket socket(io);
    boost::system::error_code ignored;
    socket.connect(acceptor_.local_endpoint(), ignored);
    thread_.join();
  }

  std::string url() const {
    return std::string(tls_ ? "https" : "http") +
           "://127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port()) + "/hook?x=1";
  }

  void AnswerWith(int status) { status_ = status; }

  // The next post; the test fails after ten seconds without one.
  Post Next() {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, std::chrono::seconds(10), [this] { return !posts_.empty(); })) {
      ADD_FAILURE() << "no post came";
      return {};
    }
    Post post = std::move(posts_.front());
    posts_.pop_front();
    return post;
  }

 private:
  void Begin() {
    thread_ = std::thread([this] { Serve(); });
  }

  void Serve() {
    for (;;) {
      boost::asio::ip::tcp::socket socket(io_);
      boost::system::error_code error;
      acceptor_.accept(socket, error);
      if (stopping_) return;
      if (!tls_) {
        Take(socket);
        continue;
      }
      boost::asio::ssl::stream<boost::asio::ip::tcp::socket> secure(std::move(socket), *tls_);
      secure.handshake(boost::asio::ssl::stream_base::server, error);
      if (!error) Take(secure);
    }
  }

  template <class Stream>
  void Take(Stream& stream) {
    namespace http = boost::beast::http;
    boost::system::error_code error;
    boost::beast::flat_buffer buffer;
    http::request<http::string_body> request;
    http::read(stream, buffer, request, error);
    if (error) return;
    Post post;
    for (const auto& field : request) {
      post.headers[std::string(field.name_string())] = std::string(field.value());
    }
    post.body = request.body();
    http::response<http::empty_body> response(static_cast<http::status>(status_.load()), 11);
    response.prepare_payload();
    http::write(stream, response, error);
    std::lock_guard lock(mutex_);
    posts_.push_back(std::move(post));
    changed_.notify_all();
  }

  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  std::optional<boost::asio::ssl::context> tls_;
  std::atomic<int> status_{204};
  std::atomic<bool> stopping_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Post> posts_;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace mortise::gateway
