#include "common/cad/step/step_structure.h"

#include <Interface_Check.hxx>
#include <STEPConstruct_ExternRefs.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <TCollection_HAsciiString.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"

namespace mortise::cad {
namespace {

constexpr std::size_t kMaxFaults = 20;
constexpr std::size_t kMaxTypes = 5;

Handle(StepData_StepModel) ModelOf(STEPCAFControl_Reader& reader) {
  return Handle(StepData_StepModel)::DownCast(reader.ChangeReader().WS()->Model());
}

// What consists of what: by entity, each as often as it is used.
struct Composition {
  std::vector<std::string> names;
  std::vector<std::vector<int>> components;
  std::map<const Standard_Transient*, int> index;

  int Find(const Standard_Transient* entity, const std::function<std::string()>& name) {
    const auto [found, is_new] = index.try_emplace(entity, static_cast<int>(names.size()));
    if (is_new) {
      names.push_back(name());
      components.emplace_back();
    }
    return found->second;
  }
};

// Counts what something consists of in the end, and finds what contains itself.
class Counter {
 public:
  explicit Counter(const Composition& composition)
      : composition_(composition),
        marks_(composition.names.size(), Mark::kNew),
        counts_(composition.names.size(), 0) {}

  // The largest count of anything; at most kMaxStepParts + 1. Without recursion: a chain of
  // sub-assemblies may be as long as the file.
  int Largest() {
    int largest = 0;
    for (std::size_t i = 0; i < counts_.size() && cycle_.empty(); ++i) {
      Visit(static_cast<int>(i));
      largest = std::max(largest, counts_[i]);
    }
    return largest;
  }

  // "a contains b contains a"; empty if nothing does.
  const std::string& cycle() const { return cycle_; }

 private:
  enum class Mark { kNew, kOpen, kDone };
  struct Step {
    int node;
    std::size_t next;  // component to look at
  };

  void Visit(int root) {
    if (MarkOf(root) != Mark::kNew) return;
    std::vector<Step> open = {{root, 0}};
    MarkOf(root) = Mark::kOpen;
    while (!open.empty()) {
      const int node = open.back().node;
      const auto& components = composition_.components[static_cast<std::size_t>(node)];
      if (open.back().next == components.size()) {
        Close(node, components);
        open.pop_back();
        continue;
      }
      const int component = components[open.back().next++];
      if (MarkOf(component) == Mark::kOpen) return Describe(open, component);
      if (MarkOf(component) != Mark::kNew) continue;
      MarkOf(component) = Mark::kOpen;
      open.push_back({component, 0});
    }
  }

  void Close(int node, const std::vector<int>& components) {
    int count = components.empty() ? 1 : 0;
    for (const int component : components) {
      count = std::min(kMaxStepParts + 1, count + counts_[static_cast<std::size_t>(component)]);
    }
    counts_[static_cast<std::size_t>(node)] = count;
    MarkOf(node) = Mark::kDone;
  }

  void Describe(const std::vector<Step>& open, int repeated) {
    constexpr std::size_t kMaxShown = 8;
    const auto begin = std::find_if(open.begin(), open.end(),
                                    [repeated](const Step& s) { return s.node == repeated; });
    std::size_t shown = 0;
    for (auto step = begin; step != open.end() && shown < kMaxShown; ++step, ++shown) {
      absl::StrAppend(&cycle_, "'", composition_.names[static_cast<std::size_t>(step->node)],
                      "' contains ");
    }
    absl::StrAppend(&cycle_, "'", composition_.names[static_cast<std::size_t>(repeated)], "'");
  }

  Mark& MarkOf(int node) { return marks_[static_cast<std::size_t>(node)]; }

  const Composition& composition_;
  std::vector<Mark> marks_;
  std::vector<int> counts_;
  std::string cycle_;
};

Composition Products(const Handle(StepData_StepModel) & model) {
  Composition products;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto usage = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(i));
    if (usage.IsNull()) continue;
    const Handle(StepBasic_ProductDefinition) whole = usage->RelatingProductDefinition();
    const Handle(StepBasic_ProductDefinition) part = usage->RelatedProductDefinition();
    if (whole.IsNull() || part.IsNull()) continue;
    const int from = products.Find(whole.get(), [&] { return ProductName(whole); });
    const int to = products.Find(part.get(), [&] { return ProductName(part); });
    products.components[static_cast<std::size_t>(from)].push_back(to);
  }
  return products;
}

// Representations that others take up as a whole, placed.
Composition Representations(const Handle(StepData_StepModel) & model) {
  Composition representations;
  const auto find = [&](const Handle(StepRepr_Representation) & representation) {
    return representations.Find(
        representation.get(), [&] { return absl::StrCat("#", model->IdentLabel(representation)); });
  };
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto whole = Handle(StepRepr_Representation)::DownCast(model->Value(i));
    if (whole.IsNull() || whole->Items().IsNull()) continue;
    for (int k = 1; k <= whole->NbItems(); ++k) {
      const auto item = Handle(StepRepr_MappedItem)::DownCast(whole->ItemsValue(k));
      if (item.IsNull() || item->MappingSource().IsNull()) continue;
      const Handle(StepRepr_Representation) mapped = item->MappingSource()->MappedRepresentation();
      if (mapped.IsNull()) continue;
      const int from = find(whole), to = find(mapped);
      representations.components[static_cast<std::size_t>(from)].push_back(to);
    }
  }
  return representations;
}

// The kernel would open the files that this one names, wherever they are.
absl::Status CheckReferences(STEPCAFControl_Reader& reader) {
  STEPConstruct_ExternRefs references(reader.ChangeReader().WS());
  references.LoadExternRefs();
  for (int i = 1; i <= references.NbExternRefs(); ++i) {
    const Handle(TCollection_HAsciiString) format = references.Format(i);
    // Drawings and other papers are left alone.
    if (!format.IsNull() && format->Search("STEP") < 1) continue;
    return InvalidField("step", "has parts in other files; export it as one file");
  }
  return absl::OkStatus();
}

// The types of entities that the kernel does not know, the first few: "entities of types …".
std::string UnknownTypes(const Handle(StepData_StepModel) & model) {
  std::set<std::string> types;
  for (int i = 1; i <= model->NbEntities() && types.size() < kMaxTypes; ++i) {
    const auto entity = Handle(StepData_UndefinedEntity)::DownCast(model->Value(i));
    if (!entity.IsNull() && !entity->IsSub()) types.insert(entity->StepType());
  }
  if (types.empty()) return "";
  return absl::StrCat("it has entities of types that are not known here, such as ",
                      absl::StrJoin(types, ", "), "; AP203, AP214 and AP242 are read");
}

// What the kernel finds wrong with an entity, "Parameter n0.2 (basis_surface) : Entity has illegal
// type", in words for people.
std::string InPlainWords(std::string_view found) {
  constexpr std::string_view kParameter = "Parameter n0.";
  if (found.starts_with("Count of Parameters")) {
    return "has more or fewer parameters than its type";
  }
  const std::size_t close = found.find(')');
  if (!found.starts_with(kParameter) || close == std::string_view::npos) return "cannot be read";
  const std::string which(found.substr(kParameter.size(), close + 1 - kParameter.size()));
  const bool is_entity = found.find("Entity") != std::string_view::npos;
  return absl::StrCat("parameter ", which,
                      is_entity ? " refers to something that cannot stand there"
                                : " is not such a value as must stand there");
}

}  // namespace

std::string ProductName(const Handle(StepBasic_ProductDefinition) & definition) {
  if (definition.IsNull() || definition->Formation().IsNull() ||
      definition->Formation()->OfProduct().IsNull()) {
    return "";
  }
  const Handle(StepBasic_Product) product = definition->Formation()->OfProduct();
  if (!product->Name().IsNull() && product->Name()->Length() > 0) {
    return product->Name()->ToCString();
  }
  return product->Id().IsNull() ? "" : product->Id()->ToCString();
}

std::vector<std::string> EntityFaults(STEPCAFControl_Reader& reader) {
  const Handle(StepData_StepModel) model = ModelOf(reader);
  std::vector<std::string> faults;
  std::string unknown = UnknownTypes(model);
  // What refers to entities of these types is wrong because of that.
  if (!unknown.empty()) return {std::move(unknown)};
  std::size_t more = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    if (!model->IsErrorEntity(i)) continue;
    if (faults.size() == kMaxFaults) {
      ++more;
      continue;
    }
    const Handle(Interface_Check) check = model->Check(i, Standard_True);
    const int line = model->IdentLabel(model->Value(i));
    const std::string what =
        check.IsNull() || check->NbFails() == 0 ? "cannot be read" : InPlainWords(check->CFail(1));
    faults.push_back(absl::StrCat("#", line, ": ", what));
  }
  if (more > 0) {
    faults.push_back(
        absl::StrCat("and ", more, more == 1 ? " more entity is" : " more entities are", " wrong"));
  }
  return faults;
}

void KeepNames(const Handle(StepData_StepModel) & model) {
  const auto is_overlooked = [](const Handle(TCollection_HAsciiString) & name) {
    if (name.IsNull() || name->UsefullLength() > 0) return false;
    const std::string text = name->ToCString();
    return std::any_of(text.begin(), text.end(), [](char c) { return (c & 0x80) != 0; });
  };
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto usage = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(i));
    if (!usage.IsNull() && is_overlooked(usage->Name())) usage->SetId(usage->Name());
    const auto product = Handle(StepBasic_Product)::DownCast(model->Value(i));
    if (!product.IsNull() && is_overlooked(product->Name())) product->SetId(product->Name());
  }
}

absl::Status CheckStructure(STEPCAFControl_Reader& reader) {
  const Handle(StepData_StepModel) model = ModelOf(reader);
  MORTISE_RETURN_IF_ERROR(CheckReferences(reader));
  for (const Composition& composition : {Products(model), Representations(model)}) {
    Counter counter(composition);
    const int largest = counter.Largest();
    if (!counter.cycle().empty()) {
      return InvalidField("step", absl::StrCat("goes in a circle: ", counter.cycle()));
    }
    if (largest > kMaxStepParts) return TooLarge("step", absl::StrCat(kMaxStepParts, " parts"));
  }
  return absl::OkStatus();
}

}  // namespace mortise::cad
