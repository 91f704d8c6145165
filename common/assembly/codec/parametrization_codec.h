// What automatic parametrisation finds and makes, as messages of mortise/v1/assembly.proto. Target
// mortise_assembly_codec; only adapters link it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/parametric_assembly.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::parametric {

// A measure as a struct: an axis or kind that is not said is x, or the size. INVALID_ARGUMENT
// naming
// "<field>.axis" or "<field>.kind" for numbers that the contract does not have.
absl::StatusOr<Measure> FromProto(const v1::Measure& message, const std::string& field);
v1::Measure ToProto(const Measure& measure);

// Demands as structs. INVALID_ARGUMENT naming "demands[i].measure.axis" or ".kind" for numbers that
// the contract does not have.
absl::StatusOr<std::vector<MeasureDemand>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::MeasureDemand>& messages);

// Parametrises an assembly with the items and shapes that it names. INVALID_ARGUMENT with
// everything that is wrong with it, fields as the message has them; FAILED_PRECONDITION as
// ParametricAssembly::Create, and CANCELLED. Takes up to seconds for hundreds of parts. With a
// `group`, the sub-tree below it by itself (sub_tree.h), "group" naming what is wrong with that.
absl::StatusOr<std::shared_ptr<const ParametricAssembly>> Parametrize(
    const v1::AssemblyBundle& bundle,
    const std::function<bool()>& is_given_up = [] { return false; }, const std::string& group = "");

// Does the same; `search` is of the assembly, or of the sub-tree below `group`.
absl::StatusOr<std::shared_ptr<const ParametricAssembly>> ParametrizeWith(
    const SearchOptions& search, const v1::AssemblyBundle& bundle,
    const std::function<bool()>& is_given_up, const std::string& group);

// Does the same; what is `known` need not be found again, and changes nothing else. `loose` says
// what becomes of elements that nothing holds.
absl::StatusOr<std::shared_ptr<const ParametricAssembly>> ParametrizeKnowing(
    const std::vector<const ParametricAssembly*>& known, const v1::AssemblyBundle& bundle,
    const std::function<bool()>& is_given_up, const std::string& group, LoosePolicy loose);

// Everything but the name and revision. Fails as ParametricAssembly::DegreesOfFreedom does.
absl::StatusOr<v1::Parametrization> ToProto(const ParametricAssembly& assembly);

// The design at q, checked, without name, revision and demands. INVALID_ARGUMENT, "q", for another
// number of parameters, one that is not finite, or a size that is not positive.
absl::StatusOr<v1::AdjustedAssembly> EvaluatedToProto(const ParametricAssembly& assembly,
                                                      const Eigen::VectorXd& q);

}  // namespace mortise::parametric
