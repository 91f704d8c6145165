#include "services/fabplanner/planning/stock_shares.h"

#include <cmath>

#include "services/fabplanner/cutting/stock_cutting.h"

namespace mortise::fabplanner {
namespace {

// A piece of stock, and the parts that are cut from it, each with its share before they are scaled.
struct SharedPiece {
  Ware ware;
  std::vector<std::pair<std::size_t, double>> takers;
};

std::map<std::string, std::size_t> PartsByLabel(const FabricationPlan& plan, const Design& design) {
  std::map<std::string, std::size_t> parts;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    for (int copy = 1; copy <= plan.quantity; ++copy) {
      parts[PartLabel(design.parts[i].name, copy, plan.quantity)] = i;
    }
  }
  return parts;
}

double AreaOf(const SheetPlacement& placement) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : placement.outline) box.extend(point);
  return box.volume();
}

// By label: strips of one plank are one piece.
std::map<std::string, SharedPiece> PiecesOf(const FabricationPlan& plan, const Design& design,
                                            const Items& items) {
  const std::map<std::string, std::size_t> parts = PartsByLabel(plan, design);
  std::map<std::string, SharedPiece> pieces;
  for (const BoardLayout& board : plan.boards) {
    const Item& item = items.at(board.item);
    SharedPiece& piece = pieces[board.plank.empty() ? board.label : board.plank];
    const double width = item.ripped ? item.size.y() : board.width;
    piece.ware = WareOf(board.item, {board.stock_length, width, board.thickness});
    for (const BoardSegment& segment : board.segments) {
      piece.takers.emplace_back(parts.at(segment.part), segment.length * board.width);
    }
  }
  for (const SheetLayout& sheet : plan.sheets) {
    SharedPiece& piece = pieces[sheet.label];
    piece.ware = WareOf(sheet.item, {sheet.length, sheet.width, sheet.thickness});
    for (const SheetPlacement& placement : sheet.placements) {
      piece.takers.emplace_back(parts.at(placement.part), AreaOf(placement));
    }
  }
  return pieces;
}

}  // namespace

Ware WareOf(const std::string& item, const Eigen::Vector3d& size) {
  const auto micrometres = [&](int axis) -> int64_t { return std::llround(size[axis] * 1e6); };
  return {item, {micrometres(0), micrometres(1), micrometres(2)}};
}

std::vector<std::map<Ware, double>> StockShares(const FabricationPlan& plan, const Design& design,
                                                const Items& items) {
  std::vector<std::map<Ware, double>> shares(design.parts.size());
  for (const auto& [label, piece] : PiecesOf(plan, design, items)) {
    double total = 0;
    for (const auto& [part, taken] : piece.takers) total += taken;
    for (const auto& [part, taken] : piece.takers) shares[part][piece.ware] += taken / total;
  }
  return shares;
}

}  // namespace mortise::fabplanner
