// One Template to every other service, whatever it is made of: parts with expressions, an assembly
// that parametrises itself (thesis §3), a list of features (§6.1) or a mesh in a cage (§7.6.2).
//
//   MORTISE_ASSIGN_OR_RETURN(std::shared_ptr<const Template> wrench, Compile(bundle));
//   MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd q, CompleteParameters(wrench->parameters(),
//   {{"length", 0.2}})); MORTISE_ASSIGN_OR_RETURN(parametric::EvaluatedDesign design,
//   wrench->Evaluate(q));
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/design/evaluated_design.h"
#include "common/design/evaluation.h"
#include "common/design/structure.h"
#include "common/design/template_definition.h"

namespace mortise::parametric {
class ParametricAssembly;
}

namespace mortise::templates {

// The head that all kinds have in common.
struct TemplateHead {
  std::string name;  // templates/{id}
  int64_t revision = 0;
  std::string digest;  // of the content and all it uses
  std::string title;
  std::vector<parametric::Parameter> parameters;  // the order of q
  std::vector<parametric::Item> items;            // that its parts are made of
  std::vector<parametric::Material> materials;    // that its parts and items are made of
};

// A template revision ready for evaluation. Immutable; safe to share between threads.
class Template {
 public:
  virtual ~Template() = default;
  Template(const Template&) = delete;
  Template& operator=(const Template&) = delete;

  const TemplateHead& head() const { return head_; }
  const std::vector<parametric::Parameter>& parameters() const { return head_.parameters; }

  // Returns F(q), with one entry of q a parameter, in their order. INVALID_ARGUMENT naming
  // "parameters[i].value" for a wrong count, a value out of range or not finite, or the template's
  // field where the design cannot be made at q; FAILED_PRECONDITION, DEMANDS_CONFLICT, where an
  // assembly cannot have all these sizes at once.
  absl::StatusOr<parametric::EvaluatedDesign> Evaluate(const Eigen::VectorXd& q) const;

  // Returns what is there, counted or chosen of the design at q, as Evaluate tells it, without the
  // time that its shapes take: of an assembly how many parts each row of it has, of parts which are
  // there, how often and of which items, of a list of features how many instances each pattern and
  // how many corners each polygon, and which are not made. Designs of one revision with the same
  // structure have the same parts, by number and name; those of assemblies, parts and cages also
  // the same vertices and triangles, part by part. A solid of features is meshed anew each time,
  // and its faces may come and go as lengths change. Fails as Evaluate, but for solids that only
  // the kernel finds cannot be made.
  absl::StatusOr<parametric::Structure> StructureAt(const Eigen::VectorXd& q) const;

  // Whether the surfaces of designs of one structure are meshed anew each time. Otherwise they have
  // the same vertices, in the same order, joined to triangles of the same faces.
  virtual bool MeshesAnew() const { return false; }

  // Whether what StructureAt tells may differ between designs other than in its counts: parts or
  // features that may be absent, parts that are repeated or of several items, choices.
  virtual bool MayLeaveOut() const;

  // Linear inequalities among parameters: normals · q <= bounds, unit rows.
  struct ParameterLimits {
    Eigen::MatrixXd normals;  // one row an inequality, one column a parameter
    Eigen::VectorXd bounds;
  };

  // Returns what parameters within their ranges must keep besides, as far as it is known without
  // making a design: of an assembly, which sizes it can have together. At its very ends rounding
  // may decide whether Evaluate fails. No rows for other kinds of templates. It takes up to seconds
  // for assemblies of hundreds of parts.
  virtual absl::StatusOr<ParameterLimits> LimitsAmongParameters() const;

  // Returns the boundary representation of each part of the design at q, in the order of Evaluate's
  // parts. A mesh in a cage has a plane for each of its triangles that lie in one. Fails as
  // Evaluate; FAILED_PRECONDITION, NO_SOLID, where a mesh in a cage bounds several solids, or none
  // that the kernel can have.
  absl::StatusOr<std::vector<cad::Solid>> Solids(const Eigen::VectorXd& q) const;

  // Whether the solids' surfaces are those that were designed, and not the triangles of a mesh. Of
  // an assembly each part's shape tells it.
  virtual bool HasExactSurfaces() const { return true; }

  // What an assembly template is made of at q: the assembly, and its parameters there.
  struct AssemblyDesign {
    std::shared_ptr<const parametric::ParametricAssembly> assembly;
    Eigen::VectorXd q;
  };

  // Returns the assembly at q; nothing for other kinds of templates. Fails as Evaluate does.
  absl::StatusOr<std::optional<AssemblyDesign>> AssemblyAt(const Eigen::VectorXd& q) const;

  // Whether Mass can be asked for.
  virtual bool OffersMassGradient() const { return false; }

  // Returns the volume and mass at q with exact gradients. Fails as Evaluate; FAILED_PRECONDITION
  // where there are no gradients.
  virtual absl::StatusOr<parametric::MassProperties> Mass(const Eigen::VectorXd& q) const;

  // Returns an estimate of the memory that it takes, bytes, for those who keep templates for reuse.
  virtual std::size_t MemoryUse() const;

 protected:
  explicit Template(TemplateHead head) : head_(std::move(head)) {}

  // Do as Evaluate, StructureAt, Solids and AssemblyAt, for parameters that have been checked;
  // name, revision, digest and parameters of the design are filled in afterwards, and of the
  // structure the choices.
  virtual absl::StatusOr<parametric::EvaluatedDesign> DesignAt(const Eigen::VectorXd& q) const = 0;
  virtual absl::StatusOr<parametric::Structure> CountsAt(const Eigen::VectorXd& q) const = 0;
  virtual absl::StatusOr<std::vector<cad::Solid>> SolidsAt(const Eigen::VectorXd& q) const;
  virtual absl::StatusOr<std::optional<AssemblyDesign>> AssemblyDesignAt(
      const Eigen::VectorXd& q) const;

 private:
  const TemplateHead head_;
};

// Returns the prisms of a design as solids, in order. INVALID_ARGUMENT as cad::Solid::FromPart.
absl::StatusOr<std::vector<cad::Solid>> SolidsOf(const parametric::EvaluatedDesign& design);

}  // namespace mortise::templates
