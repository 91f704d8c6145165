// Lets the names of faces follow the kernel's operations.
#include "common/templates/features/named_body.h"

#include <BRepAlgoAPI_BooleanOperation.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace mortise::cad {
namespace {

// The solid of a compound that has only one; else the shape itself.
TopoDS_Shape Unwrap(const TopoDS_Shape& shape) {
  TopExp_Explorer solid(shape, TopAbs_SOLID);
  if (!solid.More()) return shape;
  const TopoDS_Shape first = solid.Current();
  solid.Next();
  return solid.More() ? shape : first;
}

// Appends the faces of `result` that `face` became.
void AppendSuccessors(BRepBuilderAPI_MakeShape& operation, const TopoDS_Face& face,
                      const TopTools_IndexedMapOfShape& result, TopTools_IndexedMapOfShape& found) {
  const auto add = [&](const TopoDS_Shape& shape) {
    const int index = result.FindIndex(shape);
    if (index > 0) found.Add(result(index));
  };
  // A copy: the list belongs to the operation and changes with the next question.
  const TopTools_ListOfShape modified = operation.Modified(face);
  for (const TopoDS_Shape& successor : modified) add(successor);
  if (modified.IsEmpty() && !operation.IsDeleted(face)) add(face);
}

BOPAlgo_Operation KernelOperation(Operation operation) {
  switch (operation) {
    case Operation::kCut:
      return BOPAlgo_CUT;
    case Operation::kIntersect:
      return BOPAlgo_COMMON;
    default:
      return BOPAlgo_FUSE;
  }
}

}  // namespace

void Follow(BRepBuilderAPI_MakeShape& operation, const TopoDS_Shape& result, const FaceName& made,
            NamedBody& body) {
  body.shape = Unwrap(result);
  TopTools_IndexedMapOfShape faces, claimed;
  TopExp::MapShapes(body.shape, TopAbs_FACE, faces);
  for (NamedFaces& named : body.names) {
    TopTools_IndexedMapOfShape found;
    for (const TopoDS_Face& face : named.faces) AppendSuccessors(operation, face, faces, found);
    if (found.IsEmpty() && !named.faces.empty()) named.removed_by = made.feature;
    named.faces.clear();
    for (int i = 1; i <= found.Extent(); ++i) {
      named.faces.push_back(TopoDS::Face(found(i)));
      claimed.Add(found(i));
    }
  }
  NamedFaces rest{made, {}, {}};
  for (int i = 1; i <= faces.Extent(); ++i) {
    if (!claimed.Contains(faces(i))) rest.faces.push_back(TopoDS::Face(faces(i)));
  }
  if (!rest.faces.empty()) body.names.push_back(std::move(rest));
}

absl::Status Combine(Operation operation, const std::vector<NamedBody>& tools,
                     const std::string& feature, NamedBody& body) {
  TopTools_ListOfShape arguments, others;
  arguments.Append(body.shape);
  for (const NamedBody& tool : tools) others.Append(tool.shape);
  BRepAlgoAPI_BooleanOperation combine;
  combine.SetOperation(KernelOperation(operation));
  combine.SetArguments(arguments);
  combine.SetTools(others);
  combine.SetRunParallel(Standard_False);
  combine.SetCheckInverted(Standard_False);  // bodies never are
  combine.Build();
  if (!combine.IsDone() || combine.HasErrors()) {
    return absl::InvalidArgumentError("the kernel cannot combine the bodies");
  }
  if (operation == Operation::kUnite) combine.SimplifyResult();
  if (!TopExp_Explorer(combine.Shape(), TopAbs_SOLID).More()) {
    return absl::InvalidArgumentError(absl::StrCat("nothing is left of body '", body.name, "'"));
  }
  for (const NamedBody& tool : tools) {
    body.names.insert(body.names.end(), tool.names.begin(), tool.names.end());
  }
  Follow(combine, combine.Shape(), {feature, kNoInstance, {}}, body);
  return absl::OkStatus();
}

NamedBody CopyOf(const NamedBody& body, const gp_Trsf& placement, const std::string& pattern,
                 int instance) {
  BRepBuilderAPI_Transform transform(body.shape, placement, Standard_True);
  NamedBody copy{body.name, transform.Shape(), {}};
  for (const NamedFaces& named : body.names) {
    NamedFaces moved{{pattern, instance, named.name.role}, {}, named.removed_by};
    for (const TopoDS_Face& face : named.faces) {
      moved.faces.push_back(TopoDS::Face(transform.ModifiedShape(face)));
    }
    copy.names.push_back(std::move(moved));
  }
  return copy;
}

}  // namespace mortise::cad
