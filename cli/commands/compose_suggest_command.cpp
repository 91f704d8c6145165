#include "cli/commands/compose_suggest_command.h"

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/commands/compose_calls.h"

namespace mortise::cli {
namespace {

struct BillOptions {
  std::string model;
};

struct SuggestOptions {
  std::string model, node;
  std::vector<std::string> items, materials;
  double max_price = 0;
  int count = 0;
};

std::string PriceText(bool is_known, const v1::Money& price) {
  return is_known ? absl::StrFormat("%.2f %s", price.amount(), price.currency()) : "unknown";
}

// As `compose add --turn` takes them: "z", "zz".
std::string TurnsText(const google::protobuf::RepeatedField<int>& turns) {
  std::string text;
  for (const int axis : turns) {
    absl::StrAppend(&text, absl::AsciiStrToLower(v1::Axis_Name(static_cast<v1::Axis>(axis))));
  }
  return text;
}

std::string TrialText(v1::ComponentSuggestion::Trial trial) {
  switch (trial) {
    case v1::ComponentSuggestion::FITS:
      return "fits";
    case v1::ComponentSuggestion::HELD_IN_PART:
      return "held in part";
    default:
      return "was not tried";
  }
}

// Why it is suggested, and what is not held.
std::string WhyText(const v1::ComponentSuggestion& suggestion) {
  if (suggestion.trial_text().empty()) return suggestion.text();
  return absl::StrCat(suggestion.text(), "; but ", suggestion.trial_text());
}

absl::Status Bill(const BillOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  v1::GetModelBillRequest request;
  request.set_name(ResourceName("models", options.model));
  MORTISE_ASSIGN_OR_RETURN(const v1::ModelBill bill,
                           AskComposer(*client, &v1::ComposerService::Stub::GetModelBill, request));
  output.Line(
      absl::StrFormat("%s, revision %d: %.3g kg", request.name(), bill.revision(), bill.mass()));
  std::vector<std::vector<std::string>> rows;
  for (const v1::ModelBillLine& line : bill.lines()) {
    rows.push_back({absl::StrCat(line.quantity()), line.item().empty() ? "no item" : line.item(),
                    absl::StrFormat("%.4g x %.4g x %.4g mm", 1000 * line.size().x(),
                                    1000 * line.size().y(), 1000 * line.size().z()),
                    PriceText(line.has_piece_price(), line.piece_price()),
                    PriceText(line.has_price(), line.price())});
  }
  output.Table({"pieces", "item", "size", "each", "price"}, rows);
  for (const v1::Money& total : bill.totals()) {
    output.Line(absl::StrCat("total: ", PriceText(true, total), ", without waste"));
  }
  if (bill.unpriced_lines() > 0) {
    output.Line(absl::StrCat(bill.unpriced_lines(), " of these have no price, and are left out"));
  }
  output.DocumentOf(bill);
  return absl::OkStatus();
}

absl::Status Suggest(const SuggestOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  v1::SuggestComponentsRequest request;
  request.set_name(ResourceName("models", options.model));
  request.set_node(options.node);
  for (const std::string& item : options.items) request.add_items(ResourceName("items", item));
  for (const std::string& material : options.materials) {
    request.add_materials(ResourceName("materials", material));
  }
  request.set_max_price(options.max_price);
  request.set_count(options.count);
  MORTISE_ASSIGN_OR_RETURN(
      const v1::ComponentSuggestions found,
      AskComposer(*client, &v1::ComposerService::Stub::SuggestComponents, request));
  std::vector<std::vector<std::string>> rows;
  for (const v1::ComponentSuggestion& each : found.suggestions()) {
    rows.push_back({absl::StrFormat("%.2f", each.score()), each.template_(), each.group(),
                    TurnsText(each.turns()),
                    absl::StrFormat("%.4g, %.4g, %.4g", each.position().x(), each.position().y(),
                                    each.position().z()),
                    PriceText(each.has_price(), each.price()), TrialText(each.trial()),
                    WhyText(each)});
  }
  output.Table({"score", "template", "group", "turn", "at", "price", "tried", "why"}, rows);
  if (found.suggestions().empty()) {
    output.Line("nothing in the catalog goes beside such parts, and is missing");
  }
  if (found.not_compared() > 0) {
    output.Line(absl::StrCat("time was over before ", found.not_compared(),
                             found.not_compared() == 1 ? " more group of the catalog was compared"
                                                       : " more groups of the catalog were "
                                                         "compared"));
  }
  output.DocumentOf(found);
  return absl::OkStatus();
}

}  // namespace

void AddComposeBillCommand(CLI::App& compose, Session& session) {
  auto options = std::make_shared<BillOptions>();
  CommandFlags bill(*compose.add_subcommand("bill", "What a model is made of, with prices"));
  bill.Add("model", options->model, "Model, such as desk", "name")->required();
  bill.command().footer("Example: mortise compose bill desk");
  bill.Run(session, [options](Session& s, Output& o) { return Bill(*options, s, o); });
}

void AddComposeSuggestCommand(CLI::App& compose, Session& session) {
  auto options = std::make_shared<SuggestOptions>();
  CommandFlags suggest(*compose.add_subcommand("suggest", "What might come next in a model"));
  suggest.Add("model", options->model, "Model, such as desk", "name")->required();
  suggest.Add("--node", options->node, "Element, group or row that it shall be held by", "node");
  suggest.Add("--item", options->items, "Item at hand; may be repeated. Any if absent", "items");
  suggest.Add("--material", options->materials,
              "Material at hand, besides the items; may be repeated", "materials");
  suggest.Add("--max-price", options->max_price, "Most that it may cost; any if absent",
              "max_price");
  suggest.Add("--count", options->count, "Suggestions, 1 to 50; 10 if absent", "count");
  suggest.command().footer("Example: mortise compose suggest desk --node \"leg 1\"");
  suggest.Run(session, [options](Session& s, Output& o) { return Suggest(*options, s, o); });
}

}  // namespace mortise::cli
