#include "cli/files/design_check.h"

#include <algorithm>
#include <utility>

#include "common/files/message_checks.h"
#include "common/files/template_codec.h"
#include "common/files/template_reader.h"

namespace mortise::cli {
namespace {

using Findings = std::vector<FieldViolation>;

class DesignCheck {
 public:
  DesignCheck(const Designs& designs, const Present& present)
      : designs_(designs), present_(present) {
    for (const auto& read : designs.materials) materials_in_files_.insert(read.message().name());
    for (const auto& read : designs.items) items_in_files_.insert(read.message().name());
  }

  Findings Run() {
    for (const auto& [name, material] : present_.materials) {
      if (materials_in_files_.count(name) == 0) TakeKnown(material, materials_);
    }
    for (const auto& read : designs_.materials) CheckMaterial(read);
    for (const auto& [name, item] : present_.items) {
      if (items_in_files_.count(name) == 0) TakeKnown(item, items_);
    }
    for (const auto& read : designs_.items) CheckItem(read);
    for (const auto& read : designs_.templates) CheckTemplate(read);
    return std::move(findings_);
  }

 private:
  template <typename Message>
  void CheckName(const ReadDesign<Message>& read) {
    const std::string& name = read.message().name();
    // A name that is not there is told as such.
    if (name.empty() || read.placed.unread.count("name") != 0) return;
    if (!names_.insert(name).second) findings_.push_back({read.Place("name"), "is there twice"});
  }

  template <typename Message, typename Struct>
  void TakeKnown(const Message& message, std::vector<Struct>& known) {
    absl::StatusOr<Struct> converted = parametric::FromProto(message);
    if (converted.ok()) known.push_back(*std::move(converted));
  }

  // What is wrong with a message, which then is at fault as well where some of it is unread.
  template <typename Message>
  void Report(const ReadDesign<Message>& read, const Findings& findings) {
    AddFindings(read, findings, findings_);
    if (!findings.empty() || !read.placed.unread.empty()) at_fault_.insert(read.message().name());
  }

  void CheckMaterial(const ReadDesign<v1::Material>& read) {
    CheckName(read);
    Report(read, parametric::ValidateMaterialMessage(read.message(), read.placed.unread));
    TakeKnown(read.message(), materials_);
  }

  void CheckItem(const ReadDesign<v1::Item>& read) {
    CheckName(read);
    Findings findings =
        parametric::ValidateItemMessage(read.message(), materials_, read.placed.unread);
    if (designs_.unread_names.count(read.message().material()) != 0) {
      std::erase_if(findings,
                    [](const FieldViolation& finding) { return finding.field == "material"; });
    }
    Report(read, findings);
    TakeKnown(read.message(), items_);
  }

  bool IsAtFault(const std::string& name) const {
    return at_fault_.count(name) != 0 || designs_.unread_names.count(name) != 0;
  }

  bool UsesWhatIsAtFault(const v1::Template& message) const {
    const auto is_at_fault = [&](const auto& user) {
      const parametric::Item* const item = parametric::FindItem(items_, user.item());
      return IsAtFault(user.item()) || (item != nullptr && IsAtFault(item->material));
    };
    return std::any_of(message.parts().begin(), message.parts().end(), is_at_fault) ||
           std::any_of(message.connections().begin(), message.connections().end(), is_at_fault);
  }

  void CheckTemplate(const ReadDesign<v1::Template>& read) {
    CheckName(read);
    const v1::Template& message = read.message();
    if (message.kind_case() != v1::Template::KIND_NOT_SET || !read.placed.unread.empty() ||
        UsesWhatIsAtFault(message)) {
      return;
    }
    Report(read, parametric::ValidateTemplateMessage(message, items_, materials_));
  }

  const Designs& designs_;
  const Present& present_;
  std::vector<parametric::Material> materials_;  // of the files and the catalog
  std::vector<parametric::Item> items_;          // the same; the files' where both have one
  std::set<std::string> materials_in_files_;
  std::set<std::string> items_in_files_;
  std::set<std::string> names_;     // of the files, as far as they have been checked
  std::set<std::string> at_fault_;  // of those
  Findings findings_;
};

}  // namespace

Findings CheckDesigns(const Designs& designs, const Present& present) {
  return DesignCheck(designs, present).Run();
}

}  // namespace mortise::cli
