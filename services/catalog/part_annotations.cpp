#include "services/catalog/part_annotations.h"

#include <algorithm>
#include <map>
#include <string>

#include "absl/strings/str_cat.h"

namespace mortise::catalog {
namespace {

using parametric::Finding;

class Assigner {
 public:
  Assigner(const cad::StepAssembly& drawing, const v1::AssemblyAnnotations& annotations,
           std::vector<Finding>& findings)
      : drawing_(drawing), annotations_(annotations), findings_(findings) {
    for (const cad::StepPart& part : drawing.parts) {
      const std::string& product = drawing.products[static_cast<std::size_t>(part.product)].name;
      AddEntry(part.name, part.drawn_name, part.group, product);
    }
    for (const cad::StepLeaf& leaf : drawing.leaves) {
      AddEntry(leaf.name, leaf.drawn_name, leaf.group, leaf.product);
    }
    own_.assign(names_.size(), -1);
    products_.assign(names_.size(), -1);
  }

  Assignment Assign() {
    for (int i = 0; i < annotations_.parts_size(); ++i) AssignOne(i);
    Assignment assignment;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const int annotation = own_[i] >= 0 ? own_[i] : products_[i];
      (i < drawing_.parts.size() ? assignment.parts : assignment.leaves).push_back(annotation);
    }
    CheckLeaves(assignment);
    return assignment;
  }

 private:
  using Index = std::map<std::string, std::vector<std::size_t>>;

  void AddEntry(const std::string& name, const std::string& drawn_name, int group,
                const std::string& product) {
    const std::size_t index = names_.size();
    names_.push_back(name);
    by_name_[name].push_back(index);
    by_path_[cad::PathOf(drawing_, group, name)].push_back(index);
    by_path_[cad::PathOf(drawing_, group, drawn_name)].push_back(index);
    by_drawn_name_[drawn_name].push_back(index);
    by_product_[product].push_back(index);
  }

  void AssignOne(int annotation) {
    const v1::PartAnnotation& message = annotations_.parts(annotation);
    const std::string field = absl::StrCat("annotations.parts[", annotation, "]");
    std::size_t count = 0;
    if (message.parts().empty() == message.product().empty()) {
      findings_.push_back({message.parts().empty() ? field + ".parts" : field + ".product",
                           message.parts().empty()
                               ? "or product must say what is meant"
                               : "and parts cannot both be given; write two annotations"});
      return;
    }
    for (int i = 0; i < message.parts_size(); ++i) {
      const std::string place = absl::StrCat(field, ".parts[", i, "]");
      count += AssignTo(Find(message.parts(i)), message.parts(i), annotation, place, own_);
    }
    if (!message.product().empty()) {
      const auto found = by_product_.find(message.product());
      static const std::vector<std::size_t> none;
      count += AssignTo(found == by_product_.end() ? none : found->second, message.product(),
                        annotation, field + ".product", products_);
    }
    CheckItself(message, field, count);
  }

  // Parts by name, else by path, else by the name they have in the file.
  std::vector<std::size_t> Find(const std::string& text) const {
    for (const Index* index : {&by_name_, &by_path_, &by_drawn_name_}) {
      const auto found = index->find(text);
      if (found == index->end()) continue;
      std::vector<std::size_t> entries = found->second;
      entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
      return entries;
    }
    return {};
  }

  std::size_t AssignTo(const std::vector<std::size_t>& entries, const std::string& text,
                       int annotation, const std::string& place, std::vector<int>& owners) {
    if (entries.empty()) {
      findings_.push_back(
          {place, absl::StrCat("there is nothing called '", text, "' in the file")});
    }
    for (const std::size_t entry : entries) {
      if (owners[entry] >= 0) {
        findings_.push_back(
            {place, absl::StrCat("'", names_[entry], "' has an annotation already: parts[",
                                 owners[entry], "]")});
        continue;
      }
      owners[entry] = annotation;
    }
    return entries.size();
  }

  void CheckItself(const v1::PartAnnotation& message, const std::string& field, std::size_t count) {
    v1::PartAnnotation rest = message;
    rest.clear_parts();
    rest.clear_product();
    rest.clear_left_out();
    rest.clear_title();
    if (message.left_out() && rest.ByteSizeLong() > 0) {
      findings_.push_back({field + ".left_out", "is contradicted by what else is said"});
    }
    if (message.prominent_planes_size() > 0 && count > 1) {
      findings_.push_back(
          {field + ".prominent_planes", absl::StrCat("are of one part, not of ", count)});
    }
  }

  void CheckLeaves(const Assignment& assignment) {
    for (std::size_t i = 0; i < drawing_.leaves.size(); ++i) {
      const cad::StepLeaf& leaf = drawing_.leaves[i];
      const int annotation = assignment.leaves[i];
      if (annotation >= 0 && annotations_.parts(annotation).left_out()) continue;
      const std::string path = cad::PathOf(drawing_, leaf.group, leaf.name);
      if (annotation >= 0) {
        findings_.push_back({absl::StrCat("annotations.parts[", annotation, "]"),
                             absl::StrCat("'", path, "' is no solid; it can only be left out")});
      } else if (leaf.is_surface) {
        findings_.push_back({"step", absl::StrCat("'", path,
                                                  "' is a surface, not a solid: close it, or have "
                                                  "it left_out by an annotation")});
      }
    }
  }

  const cad::StepAssembly& drawing_;
  const v1::AssemblyAnnotations& annotations_;
  std::vector<Finding>& findings_;
  std::vector<std::string> names_;  // of parts, then of leaves
  Index by_name_, by_path_, by_drawn_name_, by_product_;
  std::vector<int> own_, products_;  // annotations of each
};

}  // namespace

Assignment AssignAnnotations(const cad::StepAssembly& drawing,
                             const v1::AssemblyAnnotations& annotations,
                             std::vector<Finding>& findings) {
  return Assigner(drawing, annotations, findings).Assign();
}

}  // namespace mortise::catalog
