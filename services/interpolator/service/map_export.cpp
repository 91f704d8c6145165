#include "services/interpolator/service/map_export.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "common/maps/lattice.h"

namespace mortise::interpolator {
namespace {

// Nodes as they are gone through on the way to a point's element. The n-th split has made nodes
// 2n + 1 and 2n + 2.
void ExportNodes(const maps::InterpolationMap& map, v1::MapTree& tree) {
  const maps::RefinementTree& refined = map.tree();
  const int nodes = refined.elements().node_count();
  tree.mutable_directions()->Resize(nodes, -1);
  tree.mutable_children()->Resize(nodes, 0);
  int child = 1;
  for (const maps::ElementSplit& split : refined.history()) {
    tree.set_directions(split.element, split.direction);
    tree.set_children(split.element, child);
    child += 2;
  }
  int number = 0;
  for (const int element : refined.Elements()) tree.set_children(element, number++);
}

void ExportElements(const maps::InterpolationMap& map, const std::vector<int>& metrics,
                    v1::MapTree& tree) {
  const maps::MapContent& content = map.content();
  Eigen::Index number = 0;
  for (const int element : map.tree().Elements()) {
    tree.add_coarsest_levels(map.tree().CoarsestLevel(element));
    tree.add_finest_levels(map.tree().FinestLevel(element));
    tree.add_cut_off(content.cut_off[static_cast<std::size_t>(number)] != 0);
    for (const int metric : metrics) tree.add_errors(content.errors(metric, number));
    ++number;
  }
}

void ExportSplines(const maps::InterpolationMap& map, const std::vector<int>& metrics,
                   v1::MapTree& tree) {
  const maps::RefinementTree& refined = map.tree();
  const bool cubic = refined.basis() == maps::Basis::kCubic;
  const Eigen::MatrixXd coefficients = cubic ? map.Coefficients() : Eigen::MatrixXd();
  for (int number = 0; number < refined.splines().count(); ++number) {
    const maps::BSpline& spline = refined.splines().At(number);
    if (!spline.active) continue;
    tree.add_levels(spline.level);
    for (int d = 0; d < map.dimension(); ++d) {
      tree.add_centres(spline.centre[static_cast<std::size_t>(d)] / maps::SpacingOf(spline.level));
    }
    if (cubic) {
      tree.add_sample_counts(0);
      for (const int metric : metrics) tree.add_coefficients(coefficients(metric, number));
      continue;
    }
    const std::vector<maps::SampleWeight> allocation = refined.Allocation(spline);
    tree.add_sample_counts(static_cast<int>(allocation.size()));
    for (const maps::SampleWeight& part : allocation) {
      tree.add_samples(part.sample);
      tree.add_weights(part.weight);
    }
  }
}

void ExportSamples(const maps::InterpolationMap& map, const std::vector<int>& metrics,
                   v1::MapTree& tree) {
  for (int sample = 0; sample < map.tree().sample_count(); ++sample) {
    const maps::LatticePoint& position = map.tree().SampleLattice(sample);
    for (int d = 0; d < map.dimension(); ++d) {
      tree.add_positions(maps::ToUnit(position[static_cast<std::size_t>(d)]));
    }
    for (const int metric : metrics) tree.add_values(map.content().values(metric, sample));
  }
}

// Takes as much of the lists of a tree as fits into each part.
class TreeCutter {
 public:
  TreeCutter(int dimension, int most) : most_(most) { Begin(dimension); }

  template <typename List, typename Mutable>
  void Take(const List& list, Mutable list_of) {
    for (int first = 0; first < list.size();) {
      if (room_ == 0) Begin(parts_.front().dimension());
      const int count = std::min(room_, list.size() - first);
      (parts_.back().*list_of)()->Add(list.begin() + first, list.begin() + first + count);
      first += count;
      room_ -= count;
    }
  }

  std::vector<v1::MapTree> Parts() && { return std::move(parts_); }

 private:
  void Begin(int dimension) {
    if (!parts_.empty()) parts_.back().set_more(true);
    parts_.emplace_back().set_dimension(dimension);
    room_ = most_;
  }

  const int most_;
  int room_ = 0;
  std::vector<v1::MapTree> parts_;
};

}  // namespace

v1::MapTree ExportTree(const maps::InterpolationMap& map, const std::vector<int>& metrics) {
  v1::MapTree tree;
  tree.set_dimension(map.dimension());
  ExportNodes(map, tree);
  ExportElements(map, metrics, tree);
  ExportSplines(map, metrics, tree);
  ExportSamples(map, metrics, tree);
  return tree;
}

std::vector<v1::MapTree> CutTree(const v1::MapTree& tree, int most) {
  TreeCutter cutter(tree.dimension(), most);
  cutter.Take(tree.directions(), &v1::MapTree::mutable_directions);
  cutter.Take(tree.children(), &v1::MapTree::mutable_children);
  cutter.Take(tree.coarsest_levels(), &v1::MapTree::mutable_coarsest_levels);
  cutter.Take(tree.finest_levels(), &v1::MapTree::mutable_finest_levels);
  cutter.Take(tree.meshes(), &v1::MapTree::mutable_meshes);
  cutter.Take(tree.cut_off(), &v1::MapTree::mutable_cut_off);
  cutter.Take(tree.errors(), &v1::MapTree::mutable_errors);
  cutter.Take(tree.levels(), &v1::MapTree::mutable_levels);
  cutter.Take(tree.centres(), &v1::MapTree::mutable_centres);
  cutter.Take(tree.sample_counts(), &v1::MapTree::mutable_sample_counts);
  cutter.Take(tree.samples(), &v1::MapTree::mutable_samples);
  cutter.Take(tree.weights(), &v1::MapTree::mutable_weights);
  cutter.Take(tree.positions(), &v1::MapTree::mutable_positions);
  cutter.Take(tree.values(), &v1::MapTree::mutable_values);
  cutter.Take(tree.coefficients(), &v1::MapTree::mutable_coefficients);
  cutter.Take(tree.shape_errors(), &v1::MapTree::mutable_shape_errors);
  cutter.Take(tree.field_errors(), &v1::MapTree::mutable_field_errors);
  return std::move(cutter).Parts();
}

std::vector<v1::MapExportPart::Sample> CutSample(const v1::MapExportPart::Sample& sample,
                                                 std::size_t most) {
  std::vector<v1::MapExportPart::Sample> parts;
  std::size_t room = 0;
  // Gives the bytes, as many as there is room for at a time, to what `field_of` finds in a part.
  const auto give = [&](const std::string& bytes, const auto& field_of) {
    std::size_t at = 0;
    do {
      if (room < 4) {
        parts.emplace_back().set_sample(sample.sample());
        parts.back().set_mesh(sample.mesh());
        room = std::max<std::size_t>(most, 4);
      }
      const std::size_t count = std::min(bytes.size() - at, room / 4 * 4);
      field_of(parts.back())->assign(bytes, at, count);
      at += count;
      room -= count;
    } while (at < bytes.size());
  };
  give(sample.positions(), [](auto& part) { return part.mutable_positions(); });
  for (const v1::MapFieldValues& field : sample.fields()) {
    give(field.values(), [&](auto& part) {
      v1::MapFieldValues& to = *part.add_fields();
      to.set_name(field.name());
      to.set_load_case(field.load_case());
      return to.mutable_values();
    });
  }
  return parts;
}

}  // namespace mortise::interpolator
