// Finds what stands in an assembly of a STEP file by the file's own words. Private to this folder:
// it brings Open CASCADE.
#pragma once

#include <STEPCAFControl_Reader.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

namespace mortise::cad {

// The kernel makes an assembly, too, of a product with several representations, as one for its body
// and one for the curves of its construction. In an assembly of the file stand only products, and
// representations that a mapped item takes up.
class StepPlaces {
 public:
  // Reads the file's placements, once shapes are made.
  explicit StepPlaces(STEPCAFControl_Reader& reader);

  // Whether `component` is a product or a mapped representation, wherever it stands.
  bool IsPlaced(const TopoDS_Shape& component) const;

  // The names of the mapped item that placed a component, and of the representation; empty if none
  // did.
  struct Names {
    std::string item, representation;
  };
  Names NamesOf(const TopoDS_Shape& component) const;

 private:
  TopTools_DataMapOfShapeInteger wholes_;  // products and mapped representations, unplaced
  TopTools_DataMapOfShapeInteger items_;   // mapped items, indices into names_
  std::vector<Names> names_;
};

}  // namespace mortise::cad
