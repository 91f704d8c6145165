// The virtual cell's door with peers that behave badly: none of them keeps another from an answer.
#include "hwbridge/virtual_cell/cell_server.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <deque>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "hwbridge/cutting/modbus_link.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes kReadVersion = {0, 1, 0, 0, 0, 6, 1, 4, 0, 0, 0, 1};
const Bytes kVersion = {0, 1, 0, 0, 0, 5, 1, 4, 2, 0, 1};

// A connection that waits at most ten seconds.
class Peer {
 public:
  explicit Peer(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{10, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ~Peer() { ::close(socket_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void Send(const Bytes& bytes) {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }

  // `size` bytes, or fewer if the cell closes or falls silent.
  Bytes Read(std::size_t size) {
    Bytes bytes(size);
    std::size_t got = 0;
    while (got < size) {
      const ssize_t count = ::recv(socket_, bytes.data() + got, size - got, 0);
      if (count <= 0) break;
      got += static_cast<std::size_t>(count);
    }
    bytes.resize(got);
    return bytes;
  }

  bool IsAnswered() {
    if (::send(socket_, kReadVersion.data(), kReadVersion.size(), MSG_NOSIGNAL) < 0) return false;
    return Read(kVersion.size()) == kVersion;
  }

  // Whether the cell has closed the connection, or does within ten seconds.
  bool IsClosed() {
    std::uint8_t byte = 0;
    const ssize_t count = ::recv(socket_, &byte, 1, 0);
    return count == 0 || (count < 0 && errno == ECONNRESET);
  }

 private:
  int socket_;
};

class CellServerTest : public testing::Test {
 protected:
  void StartCell(const CellServer::Options& options) {
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, signals_), 0);
    std::vector<std::unique_ptr<Machine>> machines;
    machines.push_back(*Machine::Start({}, std::make_unique<SimulatedMemory>(world_)));
    auto server = CellServer::Listen(options, std::move(machines));
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    thread_ = std::thread([this] { EXPECT_TRUE(server_->Run(signals_[0]).ok()); });
  }

  void TearDown() override {
    if (!thread_.joinable()) return;
    signalfd_siginfo ending{};
    ending.ssi_signo = SIGTERM;
    EXPECT_EQ(::write(signals_[1], &ending, sizeof(ending)), static_cast<ssize_t>(sizeof(ending)));
    thread_.join();
    for (const int end : signals_) ::close(end);
  }

  World world_;
  int signals_[2] = {-1, -1};
  std::unique_ptr<CellServer> server_;
  std::thread thread_;
};

TEST_F(CellServerTest, HalfAFrameKeepsNobodyWaitingAndMayBeEnded) {
  StartCell({});
  Peer slow(server_->port());
  slow.Send({kReadVersion.begin(), kReadVersion.begin() + 5});
  Peer other(server_->port());
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(other.IsAnswered());
  slow.Send({kReadVersion.begin() + 5, kReadVersion.end()});
  EXPECT_EQ(slow.Read(kVersion.size()), kVersion);
}

TEST_F(CellServerTest, RequestsInOnePieceAreAllAnswered) {
  StartCell({});
  Peer peer(server_->port());
  Bytes requests;
  Bytes answers;
  for (int i = 0; i < 100; ++i) {
    requests.insert(requests.end(), kReadVersion.begin(), kReadVersion.end());
    answers.insert(answers.end(), kVersion.begin(), kVersion.end());
  }
  peer.Send(requests);
  EXPECT_EQ(peer.Read(answers.size()), answers);
}

TEST_F(CellServerTest, IdleConnectionsMakeWayForNewOnesNotTheBusy) {
  StartCell({.connections = 4});
  Peer busy(server_->port());
  ASSERT_TRUE(busy.IsAnswered());
  std::deque<std::unique_ptr<Peer>> idle;
  for (int i = 0; i < 40; ++i) {
    idle.push_back(std::make_unique<Peer>(server_->port()));
    ASSERT_TRUE(busy.IsAnswered()) << "after " << i << " idle ones";
  }
  EXPECT_TRUE(idle.front()->IsClosed());
  Peer newcomer(server_->port());
  EXPECT_TRUE(newcomer.IsAnswered());
  EXPECT_TRUE(busy.IsAnswered());
}

TEST_F(CellServerTest, AnIdleConnectionIsClosedAfterItsTime) {
  StartCell({.idle_timeout = 0.1});
  Peer silent(server_->port());
  Peer half(server_->port());
  half.Send({0, 1, 0});
  EXPECT_TRUE(silent.IsClosed());
  EXPECT_TRUE(half.IsClosed());
}

TEST_F(CellServerTest, AForeignProtocolIsNotAnswered) {
  StartCell({});
  Peer peer(server_->port());
  Bytes foreign = kReadVersion;
  foreign[3] = 1;
  peer.Send(foreign);
  EXPECT_TRUE(peer.IsAnswered()) << "and the next one is";
}

TEST_F(CellServerTest, ALengthThatLiesEndsItsOwnConnectionOnly) {
  StartCell({});
  Peer other(server_->port());
  for (const std::uint8_t length : {0, 1, 255}) {
    Peer liar(server_->port());
    Bytes request = kReadVersion;
    request[5] = length;
    liar.Send(request);
    EXPECT_TRUE(liar.IsClosed());
    EXPECT_TRUE(other.IsAnswered());
  }
  Peer longer(server_->port());
  Bytes request = kReadVersion;
  request[5] = 7;
  request.push_back(0);
  longer.Send(request);
  EXPECT_EQ(longer.Read(9), (Bytes{0, 1, 0, 0, 0, 3, 1, 0x84, 3}));
}

TEST_F(CellServerTest, AnotherUnitIsAnsweredForByTheGateway) {
  StartCell({});
  Peer peer(server_->port());
  for (const std::uint8_t unit : {0, 2, 255}) {
    Bytes request = kReadVersion;
    request[6] = unit;
    peer.Send(request);
    EXPECT_EQ(peer.Read(9), (Bytes{0, 1, 0, 0, 0, 3, unit, 0x84, 11}));
  }
}

TEST_F(CellServerTest, APeerThatFetchesNoAnswersKeepsNobodyWaiting) {
  StartCell({});
  Peer deaf(server_->port());
  Peer other(server_->port());
  Bytes many;
  const Bytes read_all = {0, 1, 0, 0, 0, 6, 1, 3, 0, 64, 0, 121};
  for (int i = 0; i < 80; ++i) many.insert(many.end(), read_all.begin(), read_all.end());
  for (int i = 0; i < 50; ++i) {
    deaf.Send(many);
    ASSERT_TRUE(other.IsAnswered());
  }
}

TEST_F(CellServerTest, ADelayedAnswerDelaysNoOther) {
  StartCell({.delay = 0.05});
  std::deque<std::unique_ptr<Peer>> peers;
  for (int i = 0; i < 8; ++i) peers.push_back(std::make_unique<Peer>(server_->port()));
  for (const auto& peer : peers) peer->Send(kReadVersion);
  for (const auto& peer : peers) EXPECT_EQ(peer->Read(kVersion.size()), kVersion);
}

// libmodbus is a peer that others have written.
TEST_F(CellServerTest, SpeaksWithLibmodbus) {
  StartCell({});
  ModbusLink link(
      {.address = "127.0.0.1", .port = server_->port(), .unit = 1, .answer_timeout = 10.0});
  const std::uint16_t beat[] = {7};
  ASSERT_TRUE(link.Write(holding::kControllerHeartbeat, beat).ok());
  const auto status = link.ReadStatus();
  ASSERT_TRUE(status.ok()) << status.status();
  EXPECT_EQ(status->state, PackMlState::kStopped);
  const auto encoded = EncodeJob(OutlineJob("seat", 0.3, 20), 1);
  for (const auto& page : encoded->outline_pages) {
    EXPECT_TRUE(link.Write(holding::kOutlinePage, page).ok());
  }
  EXPECT_TRUE(link.Write(holding::kJob, encoded->registers).ok());
  EXPECT_EQ(link.Write(holding::kJob - 1, beat).code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(link.Write(holding::kSequenceNumber, SplitWords(1)).ok());
  EXPECT_EQ(link.ReadStatus()->result, JobResult::kParametersRefused);
}

}  // namespace
}  // namespace mortise::hwbridge
