#include "services/composer/service/new_body.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/composer/model/removal.h"
#include "services/composer/service/unheld_warnings.h"

namespace mortise::composer {
namespace {

// What the body of a model is called as an assembly: "assemblies/desk" of "models/desk".
std::string BodyName(const OpenModel& model) {
  return absl::StrCat("assemblies", model.name.substr(model.name.find('/')));
}

// The drawing that a part or joint comes from. INTERNAL where there is none.
absl::StatusOr<const Drawing*> DrawingOf(const Provenance& provenance, const MergedFrom& from) {
  switch (provenance.from) {
    case Provenance::From::kBody:
      return &from.body;
    case Provenance::From::kComponent:
      return &from.component;
    case Provenance::From::kConnection:
      break;
  }
  const auto found = from.connections.find(provenance.source);
  if (found != from.connections.end()) return found->second.drawing.get();
  return absl::InternalError(absl::StrCat("no drawing is called ", provenance.source));
}

absl::StatusOr<std::vector<CopiedFrom>> CopiesOf(const std::vector<Provenance>& provenances,
                                                 const MergedFrom& from) {
  std::vector<CopiedFrom> copies;
  for (const Provenance& provenance : provenances) {
    MORTISE_ASSIGN_OR_RETURN(const Drawing* const drawing, DrawingOf(provenance, from));
    copies.push_back({drawing, provenance.name});
  }
  return copies;
}

// Makes a drawing that was parametrised already, as `design`, the body of the model. Where reading
// it gives another assembly, if only in the last bit, it is parametrised anew: what is read after a
// restart must be what was worked with before.
absl::Status SetBody(const std::shared_ptr<const Drawing>& drawing, Design design,
                     ModelDrawings& drawings, const IsGivenUp& is_given_up, OpenModel* model) {
  if (IsDrawnAs(*drawing, design.assembly->assembly())) {
    drawings.Keep(*drawing, design.assembly);
  } else {
    MORTISE_ASSIGN_OR_RETURN(
        design.assembly, drawings.Parametrize(*drawing, "", is_given_up, {design.assembly.get()}));
    design.q = design.assembly->drawn();
  }
  design.shift.setZero();
  model->body = OpenDesign{drawing->digest, "", std::move(design)};
  return absl::OkStatus();
}

// The joints of an assembly as copies of those of one drawing, which are called the same.
std::vector<CopiedFrom> JointsOf(const parametric::Assembly& assembly, const Drawing& drawing) {
  std::vector<CopiedFrom> copies;
  for (const parametric::Joint& joint : assembly.joints) copies.push_back({&drawing, joint.name});
  return copies;
}

// Of each part of the redrawn body, which part of the drawing it is a copy of, by its name.
std::map<std::string, std::string> DrawnAs(const Redrawn& redrawn) {
  std::map<std::string, std::string> drawn_as;
  for (std::size_t i = 0; i < redrawn.drawn_as.size(); ++i) {
    drawn_as[redrawn.assembly.parts[i].name] = redrawn.drawn_as[i];
  }
  return drawn_as;
}

// Keeps of a warning the pairs that are there still, if there are any.
bool KeepPairs(const std::set<std::string>& parts, v1::ModelWarning* warning) {
  const auto is_gone = [&](const auto& pair) {
    return !parts.contains(pair.element()) || !parts.contains(pair.other_element());
  };
  auto& others = *warning->mutable_others();
  others.erase(std::remove_if(others.begin(), others.end(), is_gone), others.end());
  if (!is_gone(*warning)) return true;
  if (others.empty()) return false;
  warning->set_element(others[0].element());
  warning->set_other_element(others[0].other_element());
  warning->set_text(absl::StrCat("nothing holds '", others[0].other_element(), "' and '",
                                 others[0].element(), "' together"));
  others.erase(others.begin());
  return true;
}

// Forgets the components of which the body has no part any more, and warnings about what is gone.
void ForgetWhatIsGone(const parametric::Assembly& body, OpenModel* model) {
  std::set<std::string> there;
  for (const auto& [part, component] : model->owners) there.insert(component);
  for (const OpenLoose& loose : model->loose) there.insert(loose.id);
  std::erase_if(model->components, [&](const v1::ModelComponent& component) {
    return !there.contains(component.id());
  });
  std::set<std::string> parts;
  for (const parametric::AssemblyPart& part : body.parts) parts.insert(part.name);
  std::erase_if(model->warnings, [&](v1::ModelWarning& warning) {
    if (IsOfUnheld(warning)) return false;
    return !there.contains(warning.component()) || !KeepPairs(parts, &warning);
  });
}

}  // namespace

absl::StatusOr<std::shared_ptr<const Drawing>> TakeConnected(
    const Connected& connected, const std::string& component, const MergedFrom& from,
    ModelDrawings& drawings, const IsGivenUp& is_given_up, OpenModel* model) {
  const parametric::Assembly& merged = connected.model.assembly->assembly();
  MORTISE_ASSIGN_OR_RETURN(std::vector<CopiedFrom> parts, CopiesOf(connected.parts, from));
  // Priorities of two designs do not compare: those of what comes are another expert's.
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].keeps_priority = connected.parts[i].from == Provenance::From::kBody;
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<CopiedFrom> joints, CopiesOf(connected.joints, from));
  MORTISE_ASSIGN_OR_RETURN(Drawing drawn, DrawAnew(BodyName(*model), merged, parts, joints));
  const auto drawing = std::make_shared<const Drawing>(std::move(drawn));
  MORTISE_RETURN_IF_ERROR(SetBody(drawing, connected.model, drawings, is_given_up, model));
  const std::string& own_source = from.component.bundle.assembly().name();
  std::map<std::string, std::string> owners;
  std::set<std::string> borrowed;
  for (std::size_t i = 0; i < merged.parts.size(); ++i) {
    const Provenance& provenance = connected.parts[i];
    const std::string& name = merged.parts[i].name;
    const bool of_body = provenance.from == Provenance::From::kBody;
    const auto before = of_body ? model->owners.find(provenance.name) : model->owners.end();
    owners[name] = before == model->owners.end() ? component : before->second;
    const bool is_borrowed = of_body ? model->borrowed.contains(provenance.name)
                                     : provenance.from == Provenance::From::kConnection &&
                                           provenance.source != own_source;
    if (is_borrowed) borrowed.insert(name);
  }
  model->owners = std::move(owners);
  model->borrowed = std::move(borrowed);
  std::erase_if(model->loose, [&](const OpenLoose& loose) { return loose.id == component; });
  return drawing;
}

absl::StatusOr<std::shared_ptr<const Drawing>> TakeWithout(const std::string& node,
                                                           ModelDrawings& drawings,
                                                           const IsGivenUp& is_given_up,
                                                           OpenModel* model) {
  MORTISE_ASSIGN_OR_RETURN(const parametric::Assembly rest, WithoutNode(model->body->design, node));
  MORTISE_ASSIGN_OR_RETURN(const Redrawn redrawn, Redraw(model->body->design));
  const std::map<std::string, std::string> drawn_as = DrawnAs(redrawn);
  MORTISE_ASSIGN_OR_RETURN(const auto before, drawings.Get(model->name, model->body->drawing));
  std::vector<CopiedFrom> parts;
  std::map<std::string, std::string> owners;
  std::set<std::string> borrowed;
  for (const parametric::AssemblyPart& part : rest.parts) {
    parts.push_back({before.get(), drawn_as.at(part.name)});
    owners[part.name] = model->owners[parts.back().name];
    if (model->borrowed.contains(parts.back().name)) borrowed.insert(part.name);
  }
  MORTISE_ASSIGN_OR_RETURN(Drawing drawn,
                           DrawAnew(BodyName(*model), rest, parts, JointsOf(rest, *before)));
  const auto drawing = std::make_shared<const Drawing>(std::move(drawn));
  MORTISE_ASSIGN_OR_RETURN(Design design, AsDrawn(rest, {model->body->design.assembly.get()}));
  MORTISE_RETURN_IF_ERROR(SetBody(drawing, std::move(design), drawings, is_given_up, model));
  model->owners = std::move(owners);
  model->borrowed = std::move(borrowed);
  ForgetWhatIsGone(rest, model);
  return drawing;
}

absl::StatusOr<Drawing> DrawBody(const OpenModel& model, const std::string& name,
                                 ModelDrawings& drawings) {
  MORTISE_ASSIGN_OR_RETURN(const Redrawn redrawn, Redraw(model.body->design));
  MORTISE_ASSIGN_OR_RETURN(const auto drawing, drawings.Get(model.name, model.body->drawing));
  std::vector<CopiedFrom> parts;
  for (const std::string& drawn_as : redrawn.drawn_as) parts.push_back({drawing.get(), drawn_as});
  return DrawAnew(name, redrawn.assembly, parts, JointsOf(redrawn.assembly, *drawing));
}

}  // namespace mortise::composer
