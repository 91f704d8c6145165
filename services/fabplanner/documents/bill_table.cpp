#include "services/fabplanner/documents/bill_table.h"

#include <array>
#include <charconv>
#include <cmath>

#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "services/fabplanner/documents/csv_row.h"
#include "services/fabplanner/plan/money.h"

namespace mortise::fabplanner {
namespace {

const char* KindText(BillNodeKind kind) {
  switch (kind) {
    case BillNodeKind::kAssembly:
      return "assembly";
    case BillNodeKind::kSubAssembly:
      return "sub-assembly";
    case BillNodeKind::kPart:
      return "part";
    case BillNodeKind::kStock:
      return "stock";
    case BillNodeKind::kBought:
      return "bought";
  }
  return "";
}

// Without what sums and products add far behind the decimal point.
double Rounded(double value) { return std::round(value * 1e9) / 1e9; }

BillCell TextCell(std::string text) {
  return text.empty() ? BillCell() : BillCell(std::move(text));
}

BillCell ListCell(const std::vector<std::string>& list) {
  return TextCell(absl::StrJoin(list, "; "));
}

BillCell MoneyCell(const Money& money) {
  return money.currency.empty() ? BillCell() : BillCell(money);
}

BillCell RevisionCell(int64_t revision) {
  return revision == 0 ? BillCell() : BillCell(static_cast<double>(revision));
}

std::string CellText(const BillCell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  if (const auto* money = std::get_if<Money>(&cell)) return AmountText(*money);
  const auto* number = std::get_if<double>(&cell);
  if (number == nullptr) return "";
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), *number).ptr};
}

BillRow RowOf(const BillTree& tree, const BillNode& node, int level, const std::string& since) {
  const bool is_whole = node.parent < 0;
  const BillCell parent =
      is_whole ? BillCell() : BillCell(tree.nodes[static_cast<std::size_t>(node.parent)].id);
  return {level,
          {static_cast<double>(level),
           node.id,
           parent,
           std::string(KindText(node.kind)),
           TextCell(node.name),
           TextCell(node.title),
           Rounded(node.quantity),
           Rounded(node.total_quantity),
           TextCell(is_whole ? tree.template_name : node.item),
           RevisionCell(is_whole ? tree.template_revision : node.item_revision),
           ListCell(node.external_ids),
           TextCell(node.material),
           node.mass ? BillCell(Rounded(*node.mass)) : BillCell(),
           Rounded(node.size.x()),
           Rounded(node.size.y()),
           Rounded(node.size.z()),
           TextCell(node.dimensions),
           MoneyCell(node.unit_price),
           MoneyCell(node.price),
           TextCell(node.price.currency),
           TextCell(node.supplier),
           TextCell(node.supplier_number),
           TextCell(node.supplier_url),
           ListCell(node.parts),
           ListCell(node.artifacts),
           TextCell(since)}};
}

}  // namespace

const std::vector<BillColumn>& BillColumns() {
  static const std::vector<BillColumn> kColumns = {{"level", 6},         {"id", 10},
                                                   {"parent", 10},       {"kind", 12},
                                                   {"name", 24},         {"title", 30},
                                                   {"quantity", 10},     {"total_quantity", 14},
                                                   {"item", 26},         {"revision", 9},
                                                   {"external_ids", 20}, {"material", 24},
                                                   {"mass_kg", 10},      {"length_m", 10},
                                                   {"width_m", 10},      {"thickness_m", 12},
                                                   {"dimensions", 24},   {"unit_price", 11},
                                                   {"price", 11},        {"currency", 9},
                                                   {"supplier", 20},     {"supplier_number", 16},
                                                   {"supplier_url", 24}, {"parts", 24},
                                                   {"artifacts", 40},    {"effective_from", 21}};
  return kColumns;
}

std::vector<BillRow> BillRows(const BillTree& tree) {
  const std::string since = EffectivityText(tree.effective_from);
  std::vector<BillRow> rows;
  for (const BillNode& node : tree.nodes) {
    const int level = node.parent < 0 ? 0 : rows[static_cast<std::size_t>(node.parent)].level + 1;
    rows.push_back(RowOf(tree, node, level, since));
  }
  return rows;
}

std::string BillTreeCsv(const BillTree& tree) {
  std::string csv;
  std::vector<std::string> fields;
  for (const BillColumn& column : BillColumns()) fields.emplace_back(column.name);
  AppendCsvRow(fields, &csv);
  for (const BillRow& row : BillRows(tree)) {
    fields.clear();
    for (const BillCell& cell : row.cells) fields.push_back(CellText(cell));
    AppendCsvRow(fields, &csv);
  }
  return csv;
}

std::string EffectivityText(int64_t seconds) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%SZ", absl::FromUnixSeconds(seconds),
                          absl::UTCTimeZone());
}

}  // namespace mortise::fabplanner
