#include "services/composer/service/bill_methods.h"

#include "absl/strings/str_cat.h"
#include "common/assembly/assembly_design.h"
#include "common/base/errors.h"
#include "common/design/costs/design_bill.h"
#include "common/messages/vector_codec.h"
#include "services/composer/service/bundle_contents.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer::methods {
namespace {

void SetMoney(const parametric::Cost& cost, v1::Money* money) {
  money->set_currency(cost.currency);
  money->set_amount(cost.amount);
}

v1::ModelBillLine ToProto(const parametric::BillLine& line,
                          const std::vector<parametric::Item>& items) {
  v1::ModelBillLine message;
  message.set_item(line.item);
  message.set_quantity(line.quantity);
  *message.mutable_size() = VectorToProto(line.size);
  message.mutable_parts()->Assign(line.parts.begin(), line.parts.end());
  if (!line.price.currency.empty()) {
    SetMoney(line.piece_price, message.mutable_piece_price());
    SetMoney(line.price, message.mutable_price());
  }
  if (const parametric::Item* const item = parametric::FindItem(items, line.item)) {
    message.set_title(item->title);
    message.set_supplier(item->supplier);
    message.set_supplier_number(item->supplier_number);
    message.set_supplier_url(item->supplier_url);
  }
  return message;
}

}  // namespace

absl::StatusOr<v1::ModelBill> GetModelBill(const Composer& composer, const rpc::Call& call,
                                           const v1::GetModelBillRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const StoredModel stored, ReadModel(*composer.store, asked.name()));
  MORTISE_ASSIGN_OR_RETURN(const OpenModel model,
                           Open(stored, composer.drawings, [&call] { return call.cancelled(); }));
  if (!model.body) {
    return PreconditionFailed("MODEL_EMPTY", absl::StrCat("nothing is in ", model.name, " yet"),
                              "name");
  }
  MORTISE_ASSIGN_OR_RETURN(const auto drawing,
                           composer.drawings.Get(model.name, model.body->drawing));
  MORTISE_ASSIGN_OR_RETURN(const BundleContents contents, ContentsOf(drawing->bundle));
  const Design& body = model.body->design;
  const parametric::EvaluatedDesign design =
      parametric::DesignAt(*body.assembly, body.q, contents.items, contents.materials);
  const parametric::DesignBill bill = parametric::BillOf(design, contents.items);
  v1::ModelBill message;
  message.set_revision(stored.head.revision());
  for (const parametric::BillLine& line : bill.lines) {
    *message.add_lines() = ToProto(line, contents.items);
  }
  for (const parametric::Cost& total : bill.totals) SetMoney(total, message.add_totals());
  message.set_unpriced_lines(bill.unpriced);
  message.set_mass(design.mass);
  return message;
}

}  // namespace mortise::composer::methods
