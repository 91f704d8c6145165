// GatewayService: what runs in the house.
#include <future>
#include <vector>

#include "common/rpc/method_overrides.h"
#include "gateway/contract/contract.h"
#include "gateway/forwarding/hosted_services.h"
#include "gateway/forwarding/upstreams.h"
#include "mortise/v1/gateway.grpc.pb.h"

namespace mortise::gateway {
namespace {

constexpr absl::Duration kHealthPatience = absl::Seconds(1);

absl::StatusOr<v1::House> GetHouse(const HostedEnvironment& environment, const rpc::Call&,
                                   const v1::GetHouseRequest&) {
  v1::House house;
  house.set_version(environment.version);
  std::vector<std::future<bool>> answers;
  for (const auto& [name, address] : environment.upstreams->addresses()) {
    v1::House::Service& service = *house.add_services();
    service.set_name(name);
    service.set_address(address);
    for (const MethodRoute& method : environment.contract->methods()) {
      if (method.service == name) service.add_methods(method.full_name);
    }
    answers.push_back(std::async(std::launch::async, [&environment, name = name] {
      return environment.upstreams->Healthy(name, kHealthPatience);
    }));
  }
  for (std::size_t i = 0; i < answers.size(); ++i) {
    house.mutable_services(static_cast<int>(i))->set_healthy(answers[i].get());
  }
  return house;
}

class HouseService final : public v1::GatewayService::CallbackService {
  using Contract = v1::GatewayService::CallbackService;

 public:
  explicit HouseService(const HostedEnvironment& environment)
      : environment_(environment), endpoint_(environment.dispatcher, "mortise.v1.GatewayService") {}

  MORTISE_QUERY(GetHouse, rpc::With(environment_, gateway::GetHouse))

 private:
  const HostedEnvironment environment_;
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeHouseService(const HostedEnvironment& environment) {
  return std::make_shared<HouseService>(environment);
}

}  // namespace mortise::gateway
