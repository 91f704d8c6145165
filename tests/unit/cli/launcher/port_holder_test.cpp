#include "cli/launcher/port_holder.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "common/base/port_reservation.h"

namespace mortise::cli {
namespace {

using ::testing::HasSubstr;

int PortOf(const PortReservation& reservation) {
  const std::string& address = reservation.address();
  return std::stoi(address.substr(address.rfind(':') + 1));
}

TEST(PortHolder, NamesTheProcessThatListens) {
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  ASSERT_EQ(::bind(listener, generic, length), 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  ASSERT_EQ(::getsockname(listener, generic, &length), 0);
  EXPECT_THAT(PortHolder(ntohs(address.sin_port)),
              HasSubstr("(process " + std::to_string(::getpid()) + ")"));
  ::close(listener);
}

TEST(PortHolder, SaysNothingWhereNobodyListens) {
  const auto reserved = PortReservation::Take(0, "port");
  ASSERT_TRUE(reserved.ok()) << reserved.status();
  EXPECT_EQ(PortHolder(PortOf(*reserved)), "");
}

}  // namespace
}  // namespace mortise::cli
