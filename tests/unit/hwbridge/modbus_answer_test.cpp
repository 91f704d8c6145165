// The virtual cell as a Modbus server, byte by byte: what it answers, and by which exception not.
#include "hwbridge/virtual_cell/modbus_answer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "hwbridge/virtual_cell/modbus_frame.h"
#include "tests/unit/hwbridge/cutting/simulated_cell.h"

namespace mortise::hwbridge {
namespace {

using Bytes = std::vector<std::uint8_t>;

class ModbusAnswerTest : public testing::Test {
 protected:
  ModbusAnswerTest() : machine_(*Machine::Start({}, std::make_unique<SimulatedMemory>(world_))) {}

  Bytes Ask(const Bytes& request) { return AnswerTo(request, *machine_); }

  // The exception that `request` is answered with; 0 for an answer.
  int Exception(const Bytes& request) {
    const Bytes answer = Ask(request);
    if ((answer.at(0) & 0x80) == 0) return 0;
    EXPECT_EQ(answer.size(), 2u);
    EXPECT_EQ(answer[0], request[0] | 0x80);
    return answer.at(1);
  }

  World world_;
  std::unique_ptr<Machine> machine_;
};

TEST_F(ModbusAnswerTest, ReadsTheStatus) {
  const Bytes answer = Ask({4, 0, 0, 0, 22});
  ASSERT_EQ(answer.size(), 2u + 44u);
  EXPECT_EQ(answer[0], 4);
  EXPECT_EQ(answer[1], 44);
  EXPECT_EQ(answer[3], kRegisterMapVersion);
  EXPECT_EQ(Ask({4, 0, 21, 0, 1}), (Bytes{4, 2, 0, 0}));
  EXPECT_EQ(Ask({2, 0, 0, 0, 1}), (Bytes{2, 1, 0}));
  machine_->SetEmergencyStop(true);
  EXPECT_EQ(Ask({2, 0, 0, 0, 1}), (Bytes{2, 1, 1}));
}

TEST_F(ModbusAnswerTest, WritesAndReadsBack) {
  EXPECT_EQ(Ask({6, 0, 0, 0x12, 0x34}), (Bytes{6, 0, 0, 0x12, 0x34}));
  EXPECT_EQ(Ask({3, 0, 0, 0, 2}), (Bytes{3, 4, 0x12, 0x34, 0, 0}));
  EXPECT_EQ(Ask({16, 0, 48, 0, 2, 4, 1, 2, 3, 4}), (Bytes{16, 0, 48, 0, 2}));
  EXPECT_EQ(Ask({3, 0, 48, 0, 2}), (Bytes{3, 4, 1, 2, 3, 4}));
}

TEST_F(ModbusAnswerTest, OtherFunctionsAreIllegal) {
  for (int function = 0; function < 256; ++function) {
    const bool known = function == 2 || function == 3 || function == 4 || function == 6 ||
                       function == 16 || (function & 0x80) != 0;
    if (known) continue;
    EXPECT_EQ(Exception({static_cast<std::uint8_t>(function), 0, 0, 0, 1}), 1) << function;
  }
}

TEST_F(ModbusAnswerTest, RegistersThatTheMapDoesNotHaveAreIllegalAddresses) {
  for (const Bytes& request : std::vector<Bytes>{{4, 0, 22, 0, 1},       // past the status
                                                 {4, 0, 20, 0, 3},       // over its end
                                                 {4, 0xff, 0xff, 0, 1},  //
                                                 {3, 0, 3, 0, 1},        // between command and job
                                                 {3, 0, 2, 0, 15},       // over that gap
                                                 {3, 0, 50, 0, 1},       // between job and number
                                                 {3, 0, 56, 0, 3},   // over the end of the number
                                                 {3, 0, 63, 0, 2},   // into the window
                                                 {3, 0, 185, 0, 1},  // past the window
                                                 {2, 0, 1, 0, 1},    // there is one discrete input
                                                 {2, 0, 0, 0, 2},    //
                                                 {6, 0, 3, 0, 0},    // writes into gaps
                                                 {6, 0, 15, 0, 0},   //
                                                 {6, 0, 63, 0, 0},   //
                                                 {6, 0, 65, 0, 0},   // a window not from its start
                                                 {6, 0, 185, 0, 0},  //
                                                 {16, 0, 2, 0, 2, 4, 0, 0, 0, 0}}) {
    EXPECT_EQ(Exception(request), 2) << int{request[0]} << " at " << int{request[2]};
  }
}

TEST_F(ModbusAnswerTest, CountsAndLengthsThatCannotBeAreIllegalValues) {
  Bytes too_many = {16, 0, 64, 0, 124, 248};
  too_many.resize(6 + 248);
  for (const Bytes& request : std::vector<Bytes>{{4, 0, 0, 0, 0},        // nothing asked
                                                 {4, 0, 0, 0, 126},      // more than fits
                                                 {3, 0, 0, 0xff, 0xff},  //
                                                 {2, 0, 0, 0x07, 0xd1},  //
                                                 {4, 0, 0, 0},           // too short
                                                 {4, 0, 0, 0, 1, 0},     // too long
                                                 {4},
                                                 {6, 0, 0, 1},
                                                 {6, 0, 0, 0, 1, 0},
                                                 {6, 0, 56, 0, 1},  // half a number
                                                 {6, 0, 57, 0, 1},
                                                 {16, 0, 0, 0, 1},              // no values
                                                 {16, 0, 0, 0, 1, 2, 0},        // half a value
                                                 {16, 0, 0, 0, 1, 2, 0, 1, 0},  // one byte more
                                                 {16, 0, 0, 0, 2, 2, 0, 1},     // count lies
                                                 {16, 0, 0, 0, 1, 4, 0, 1},     // bytes lie
                                                 {16, 0, 0, 0, 0, 0},           // nothing
                                                 {16, 0, 64, 0, 3, 6, 0, 0, 0, 1, 0, 1},
                                                 {6, 0, 1, 0, 10},  // no command
                                                 {6, 0, 2, 0, 2},   // no request
                                                 {16, 0, 1, 0, 2, 4, 0, 0, 0, 1},
                                                 too_many}) {
    EXPECT_EQ(Exception(request), 3) << int{request[0]} << " of " << request.size();
  }
  EXPECT_EQ(machine_->HoldingRegisters()[0], 0) << "nothing of all that was written";
}

TEST_F(ModbusAnswerTest, AnythingIsAnswered) {
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    Bytes request(1 + random() % 30);
    for (std::uint8_t& byte : request) byte = static_cast<std::uint8_t>(random() % 20);
    const Bytes answer = Ask(request);
    ASSERT_GE(answer.size(), 2u);
    ASSERT_LE(answer.size(), 253u);
    ASSERT_EQ(answer[0] & 0x7f, request[0] & 0x7f);
  }
}

Bytes Frame(std::uint16_t protocol, std::size_t length, const Bytes& rest) {
  Bytes frame = {0,
                 9,
                 static_cast<std::uint8_t>(protocol >> 8),
                 static_cast<std::uint8_t>(protocol),
                 static_cast<std::uint8_t>(length >> 8),
                 static_cast<std::uint8_t>(length)};
  frame.insert(frame.end(), rest.begin(), rest.end());
  return frame;
}

TEST(FrameReader, CutsFramesOutOfAnyPieces) {
  const Bytes one = Frame(0, 6, {1, 4, 0, 0, 0, 22});
  Bytes stream;
  for (int i = 0; i < 5; ++i) stream.insert(stream.end(), one.begin(), one.end());
  for (std::size_t piece = 1; piece <= stream.size(); ++piece) {
    FrameReader reader;
    int frames = 0;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      reader.Add(std::span(stream).subspan(at, std::min(piece, stream.size() - at)));
      while (const auto frame = reader.Next()) {
        ++frames;
        EXPECT_EQ(frame->transaction, 9);
        EXPECT_EQ(frame->unit, 1);
        EXPECT_EQ(frame->pdu, (Bytes{4, 0, 0, 0, 22}));
        EXPECT_EQ(EncodeFrame(*frame), one);
      }
    }
    EXPECT_EQ(frames, 5);
    EXPECT_FALSE(reader.broken());
  }
}

TEST(FrameReader, PassesOverOtherProtocols) {
  FrameReader reader;
  reader.Add(Frame(1, 6, {1, 4, 0, 0, 0, 22}));
  reader.Add(Frame(0, 3, {2, 7, 7}));
  const auto frame = reader.Next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->unit, 2);
  EXPECT_FALSE(reader.Next());
  EXPECT_FALSE(reader.broken());
}

TEST(FrameReader, ALengthThatNoFrameHasEndsIt) {
  for (const std::size_t length : {0u, 1u, 255u, 65535u}) {
    FrameReader reader;
    reader.Add(Frame(0, length, {1, 4, 0, 0, 0, 22}));
    EXPECT_FALSE(reader.Next()) << length;
    EXPECT_TRUE(reader.broken()) << length;
    reader.Add(Frame(0, 6, {1, 4, 0, 0, 0, 22}));
    EXPECT_FALSE(reader.Next()) << length;
  }
}

}  // namespace
}  // namespace mortise::hwbridge
