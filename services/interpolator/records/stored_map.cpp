#include "services/interpolator/records/stored_map.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "stored_map.pb.h"

namespace mortise::interpolator {
namespace {

constexpr int kVersion = 1;
constexpr int kLinear = 1;
constexpr int kCubic = 2;

stored::Structure ToStored(const maps::MapContent& content) {
  stored::Structure structure;
  structure.set_dimension(content.dimension);
  structure.set_basis(content.basis == maps::Basis::kCubic ? kCubic : kLinear);
  structure.set_most_disparity(content.options.most_disparity);
  structure.set_most_depth(content.options.most_depth);
  for (const maps::ElementSplit& split : content.splits) {
    structure.add_split_elements(split.element);
    structure.add_split_directions(split.direction);
  }
  structure.set_metrics(static_cast<int>(content.values.rows()));
  structure.mutable_values()->Add(content.values.data(),
                                  content.values.data() + content.values.size());
  structure.mutable_errors()->Add(content.errors.data(),
                                  content.errors.data() + content.errors.size());
  for (std::size_t i = 0; i < content.cut_off.size(); ++i) {
    if (content.cut_off[i] != 0) structure.add_cut_off(static_cast<int>(i));
  }
  return structure;
}

// Columns of `rows` numbers.
absl::StatusOr<Eigen::MatrixXd> ToMatrix(const google::protobuf::RepeatedField<double>& numbers,
                                         int rows) {
  if (rows <= 0 || numbers.size() % rows != 0) {
    return absl::DataLossError("its numbers are not as many as its metrics ask for");
  }
  return Eigen::MatrixXd(
      Eigen::Map<const Eigen::MatrixXd>(numbers.data(), rows, numbers.size() / rows));
}

absl::StatusOr<maps::InterpolationMap> FromStored(const stored::Structure& structure) {
  maps::MapContent content;
  content.dimension = structure.dimension();
  content.basis = structure.basis() == kCubic ? maps::Basis::kCubic : maps::Basis::kLinear;
  content.options.most_disparity = structure.most_disparity();
  content.options.most_depth = structure.most_depth();
  if (structure.split_elements_size() != structure.split_directions_size()) {
    return absl::DataLossError("its splits have not as many directions as elements");
  }
  for (int i = 0; i < structure.split_elements_size(); ++i) {
    content.splits.push_back({structure.split_elements(i), structure.split_directions(i)});
  }
  MORTISE_ASSIGN_OR_RETURN(content.values, ToMatrix(structure.values(), structure.metrics()));
  MORTISE_ASSIGN_OR_RETURN(content.errors, ToMatrix(structure.errors(), structure.metrics()));
  content.cut_off.resize(static_cast<std::size_t>(content.errors.cols()));
  for (const int element : structure.cut_off()) {
    if (element < 0 || element >= content.errors.cols()) {
      return absl::DataLossError("it has cut off an element that it does not have");
    }
    content.cut_off[static_cast<std::size_t>(element)] = 1;
  }
  return maps::InterpolationMap::Create(std::move(content));
}

}  // namespace

std::string SerializeMap(const std::vector<maps::MapContent>& structures) {
  stored::Map map;
  map.set_version(kVersion);
  for (const maps::MapContent& content : structures) *map.add_structures() = ToStored(content);
  return map.SerializeAsString();
}

absl::StatusOr<std::vector<maps::InterpolationMap>> ParseMap(std::string_view bytes) {
  stored::Map map;
  if (!map.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return absl::DataLossError("it is no map");
  }
  if (map.version() != kVersion) {
    return absl::DataLossError(
        absl::StrCat("it is of version ", map.version(), ", not ", kVersion));
  }
  std::vector<maps::InterpolationMap> structures;
  for (const stored::Structure& structure : map.structures()) {
    absl::StatusOr<maps::InterpolationMap> read = FromStored(structure);
    if (!read.ok()) return absl::DataLossError(read.status().message());
    structures.push_back(*std::move(read));
  }
  return structures;
}

}  // namespace mortise::interpolator
