// What stands in an assembly of a STEP file by the file's own words. Private to this folder: it
// brings Open CASCADE.
#pragma once

#include <STEPCAFControl_Reader.hxx>
#include <TopTools_DataMapOfShapeInteger.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

namespace mortise::cad {

// The kernel makes an assembly, too, of a product with several representations, as one for its body
// and one for the curves of its construction. What stands in an assembly of the file is a product,
// or a representation that a mapped item takes up.
class StepPlaces {
 public:
  // Once shapes are made.
  explicit StepPlaces(STEPCAFControl_Reader& reader);

  // Whether `component` is a product or a mapped representation, wherever it stands.
  bool IsPlaced(const TopoDS_Shape& component) const;

  // The name of the mapped item that placed it, and of the representation; empty if none did.
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
