// Pieces that several commands share: parameters from the command line, files from streams, and
// lists read page by page.
#pragma once

#include <grpcpp/client_context.h>
#include <grpcpp/support/sync_stream.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"
#include "cli/client/output.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.pb.h"
#include "mortise/v1/types.pb.h"

namespace mortise::cli {

// Reads a number with an optional unit of a length or an angle: "1.2", "1.2 m", "1200mm", "120cm",
// "0.5in", "45deg"; inches (in or ") also as fractions: 1/8", "1 3/4 in". It is in SI.
// INVALID_ARGUMENT naming `field`, and the units where the text has none of them.
absl::StatusOr<double> ParseQuantity(const std::string& text, const std::string& field);

// Reads a length in the same way, in metres: an angle is refused.
absl::StatusOr<double> ParseLength(const std::string& text, const std::string& field);

// Reads an angle in the same way, in radians: a length is refused.
absl::StatusOr<double> ParseAngle(const std::string& text, const std::string& field);

// Reads a metric in the same way: with a length, a mass (kg, g), a pressure (Pa, kPa, MPa, GPa), a
// force (N, kN) or a frequency (Hz, kHz) as unit, in SI.
absl::StatusOr<double> ParseMetricValue(const std::string& text, const std::string& field);

// Fails with INVALID_ARGUMENT naming `field` where `text`, a value that ParseMetricValue reads or a
// range "LOW:HIGH" of such, is said with a unit that is none of `unit`, in SI: 18mm is no mass in
// kg. What is said without a unit is in SI.
absl::Status CheckUnit(const std::string& text, const std::string& unit, const std::string& field);

// Returns whether such a text is said with a unit.
bool HasUnit(const std::string& text);

// What a metric or parameter shall keep to; either end may be missing, not both.
struct NamedRange {
  std::string name;
  std::optional<double> low;
  std::optional<double> high;
};

using ValueParser = absl::StatusOr<double>(const std::string& text, const std::string& field);

// Reads "NAME=LOW:HIGH", "NAME=LOW:" or "NAME=:HIGH", the ends as `parse` does. INVALID_ARGUMENT
// naming `option`.
absl::StatusOr<NamedRange> ParseRange(const std::string& text, const std::string& option,
                                      ValueParser& parse = ParseMetricValue);

// Reads "X, Y, Z" in SI. INVALID_ARGUMENT naming `field`.
absl::StatusOr<v1::Vector3> ParseVector(const std::string& text, const std::string& field);

// Reads "name=value", the values as ParseQuantity does. INVALID_ARGUMENT naming "--set".
absl::StatusOr<std::vector<v1::ParameterValue>> ParseParameters(
    const std::vector<std::string>& assignments);

// Reads what somebody asks of an element of an assembly: "shelf 1.x=1200mm" for its size along an
// axis, or "leg.z.maximum=0.7", with size, center, minimum or maximum; the value as ParseLength
// reads it. INVALID_ARGUMENT naming "--set TEXT".
absl::StatusOr<v1::MeasureDemand> ParseDemand(const std::string& text);

// Reads "x", "y" or "z", or nothing for an axis that is not said. INVALID_ARGUMENT naming `field`.
absl::StatusOr<v1::Axis> ParseAxis(const std::string& text, const std::string& field);

// Returns "templates/table" for "table" as for "templates/table".
std::string ResourceName(const std::string& collection, const std::string& name);

// Writes a length for people, in millimetres with its unit.
std::string Millimetres(double metres);

// Returns the value, in SI, as a metric.
v1::Metric MetricOf(const std::string& unit, double value);

// Writes a metric for people: lengths in mm, stresses in MPa (Pa where they are small), the rest in
// SI.
std::string MetricText(const v1::Metric& metric);

// Writes what a stream of chunks carries, after checking size and digest. Returns the size.
absl::StatusOr<std::int64_t> Receive(grpc::ClientReader<v1::Chunk>& reader,
                                     const std::filesystem::path& path);

// Most bytes of a file that fit into a message; larger ones are uploaded first.
inline constexpr std::size_t kMaxInMessage = 4'000'000;

// Returns OK if the design has no faults; else FAILED_PRECONDITION, DESIGN_FAULTY, with how many
// there are and the first.
absl::Status FaultsToStatus(const std::string& design,
                            const google::protobuf::RepeatedPtrField<std::string>& faults);

// Takes all pages of a list method, one after the other: of what meets the filters of `request`.
template <typename Request, typename Response, typename Method, typename Take>
absl::Status ListAll(const GatewayClient& client, Method method, Take take, Request request = {});

template <typename Request, typename Response, typename Method, typename Take>
absl::Status ListAll(const GatewayClient& client, Method method, Take take, Request request) {
  request.set_page_size(1000);
  do {
    Response response;
    MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc(method(&context, request, &response));
    }));
    take(response);
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return absl::OkStatus();
}

}  // namespace mortise::cli
