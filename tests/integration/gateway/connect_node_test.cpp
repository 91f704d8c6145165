// Runs the real Connect client for Node (tests/node) against a gateway.
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>

#include "gateway/contract/contract.h"
#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

class ConnectNodeTest : public GatewayTest {};

TEST_F(ConnectNodeTest, TheRealClientIsContent) {
  StartGateway(Options());
  const auto descriptors = folder_.path() / "contract.descriptors";
  std::ofstream(descriptors, std::ios::binary) << ContractBytes();
  const std::string command = "cd '" MORTISE_NODE_FOLDER "' && MORTISE_GATEWAY=http://" +
                              gateway_->addresses().http + " MORTISE_DESCRIPTORS='" +
                              descriptors.string() + "' node --test connect_client.test.mjs 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string output;
  char buffer[4096];
  while (const std::size_t size = fread(buffer, 1, sizeof(buffer), pipe)) {
    output.append(buffer, size);
  }
  const int status = pclose(pipe);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << output;
}

}  // namespace
}  // namespace mortise::gateway
