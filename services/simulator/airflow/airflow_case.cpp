#include "services/simulator/airflow/airflow_case.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/mesh/mass_properties.h"

namespace mortise::simulator {
namespace {

constexpr double kPrandtl = 0.71;

// Of the oncoming air: a quiet tunnel, and eddies of a tenth of the body's size.
constexpr double kTurbulenceIntensity = 0.005;
constexpr double kTurbulenceLength = 0.1;

constexpr double kBefore = 4, kBehind = 8, kBeside = 4;  // of the body's largest extent

// Cells at the body for each that its area alone would take: those in the layers around it, where
// they get coarser (measured on a plane, a cube and a ball).
constexpr double kCellsPerSurfaceCell = 5;

// Where cells would become more than these times those wanted, they stay coarser.
constexpr int kMaxCellsOverWanted = 4;

std::string Text(const Eigen::Vector3d& v) {
  return absl::StrFormat("(%.12g %.12g %.12g)", v.x(), v.y(), v.z());
}

std::string File(const std::string& type, const std::string& object, const std::string& body) {
  return absl::StrCat("FoamFile\n{\n  version 2.0;\n  format ascii;\n  class ", type,
                      ";\n  object ", object, ";\n}\n", body);
}

std::string Dictionary(const std::string& object, const std::string& body) {
  return File("dictionary", object, body);
}

// A field of the flow with its values on the faces of the domain.
std::string Field(const std::string& name, const std::string& type, const std::string& dimensions,
                  const std::string& value, const std::array<std::string, 4>& faces) {
  const auto& [inlet, outlet, sides, body] = faces;
  return File(type, name,
              absl::StrCat("dimensions ", dimensions, ";\ninternalField uniform ", value,
                           ";\nboundaryField\n{\n  inlet { ", inlet, " }\n  outlet { ", outlet,
                           " }\n  sides { ", sides, " }\n  body { ", body, " }\n}\n"));
}

constexpr char kGiven[] = "type fixedValue; value $internalField;";
constexpr char kFree[] = "type zeroGradient;";
constexpr char kSlip[] = "type slip;";
constexpr char kComputed[] = "type calculated; value $internalField;";
// Lets out what comes; what turns back at the outlet is as the oncoming air.
constexpr char kOutlet[] = "type inletOutlet; inletValue $internalField; value $internalField;";

void AddFields(const AirflowDomain& domain, const parametric::Air& air, double speed,
               std::map<std::string, std::string>& files) {
  const double extent = domain.box.sizes().x() / (kBefore + kBehind);
  const double k = 1.5 * std::pow(kTurbulenceIntensity * speed, 2);
  const double omega = std::sqrt(k) / (std::pow(0.09, 0.25) * kTurbulenceLength * extent);
  const auto number = [](double value) { return absl::StrFormat("%.12g", value); };
  const std::string scalar = "volScalarField";
  files["0/U"] =
      Field("U", "volVectorField", "[0 1 -1 0 0 0 0]", Text({speed, 0, 0}),
            {kGiven, "type inletOutlet; inletValue uniform (0 0 0); value $internalField;", kSlip,
             "type noSlip;"});
  files["0/p"] =
      Field("p", scalar, "[1 -1 -2 0 0 0 0]", number(air.pressure), {kFree, kGiven, kSlip, kFree});
  files["0/T"] = Field("T", scalar, "[0 0 0 1 0 0 0]", number(air.temperature),
                       {kGiven, kOutlet, kSlip, kFree});
  files["0/k"] = Field("k", scalar, "[0 2 -2 0 0 0 0]", number(k),
                       {kGiven, kOutlet, kSlip, "type kqRWallFunction; value $internalField;"});
  files["0/omega"] =
      Field("omega", scalar, "[0 0 -1 0 0 0 0]", number(omega),
            {kGiven, kOutlet, kSlip, "type omegaWallFunction; value $internalField;"});
  files["0/nut"] =
      Field("nut", scalar, "[0 2 -1 0 0 0 0]", "0",
            {kComputed, kComputed, kSlip, "type nutkWallFunction; value $internalField;"});
  files["0/alphat"] = Field("alphat", scalar, "[1 -1 -1 0 0 0 0]", "0",
                            {kComputed, kComputed, kSlip,
                             "type compressible::alphatWallFunction; value $internalField;"});
}

// The box; its corners 0 to 3 are those below, counter-clockwise from above.
std::string BlockMesh(const AirflowDomain& domain) {
  std::string corners;
  using Box = Eigen::AlignedBox3d;
  for (const auto corner :
       {Box::BottomLeftFloor, Box::BottomRightFloor, Box::TopRightFloor, Box::TopLeftFloor,
        Box::BottomLeftCeil, Box::BottomRightCeil, Box::TopRightCeil, Box::TopLeftCeil}) {
    absl::StrAppend(&corners, "  ", Text(domain.box.corner(corner)), "\n");
  }
  return Dictionary(
      "blockMeshDict",
      absl::StrFormat("scale 1;\nvertices\n(\n%s);\n"
                      "blocks ( hex (0 1 2 3 4 5 6 7) (%d %d %d) simpleGrading (1 1 1) );\n"
                      "edges ();\nboundary\n(\n"
                      "  inlet { type patch; faces ( (0 4 7 3) ); }\n"
                      "  outlet { type patch; faces ( (1 2 6 5) ); }\n"
                      "  sides { type patch; faces ( (0 1 5 4) (3 7 6 2) (0 3 2 1) (4 5 6 7) ); }\n"
                      ");\n",
                      corners, domain.divisions.x(), domain.divisions.y(), domain.divisions.z()));
}

// The levels of cells by their distances from the body, the nearest first: all cells that may meet
// it are halved, also those that it slips through between the middles.
std::string DistanceLevels(const AirflowDomain& domain) {
  constexpr double kHalfDiagonal = 0.87;  // of a cube of edge 1
  std::string levels;
  for (int level = domain.levels; level > 0; --level) {
    const double halved = domain.surface_cell * std::exp2(domain.levels - level + 1);
    absl::StrAppendFormat(&levels, "(%.9g %d) ", kHalfDiagonal * halved, level);
  }
  return levels;
}

std::string SnappyHexMesh(const AirflowDomain& domain) {
  // In the corner behind the inlet, off the faces of all cells there.
  const Eigen::Vector3d cell = domain.box.sizes().array() / domain.divisions.cast<double>();
  const Eigen::Vector3d outside =
      domain.box.min() + cell.cwiseProduct(Eigen::Vector3d(0.37, 0.41, 0.43));
  return Dictionary("snappyHexMeshDict",
                    absl::StrFormat(
                        R"(castellatedMesh true;
snap true;
addLayers false;
geometry { body.stl { type triSurfaceMesh; name body; } }
castellatedMeshControls
{
  maxLocalCells %1$d;
  maxGlobalCells %1$d;
  minRefinementCells 0;
  nCellsBetweenLevels 2;
  features ();
  refinementSurfaces { body { level (%2$d %2$d); patchInfo { type wall; } } }
  resolveFeatureAngle 30;
  refinementRegions { body { mode distance; levels ( %3$s); } }
  locationInMesh %4$s;
  allowFreeStandingZoneFaces false;
}
snapControls
{
  nSmoothPatch 3;
  tolerance 2;
  nSolveIter 30;
  nRelaxIter 5;
  nFeatureSnapIter 10;
  implicitFeatureSnap true;
  explicitFeatureSnap false;
  multiRegionFeatureSnap false;
}
addLayersControls {}
meshQualityControls
{
  maxNonOrtho 65;
  maxBoundarySkewness 20;
  maxInternalSkewness 4;
  maxConcave 80;
  minVol %5$.3g;
  minTetQuality 1e-15;
  minArea -1;
  minTwist 0.02;
  minDeterminant 0.001;
  minFaceWeight 0.05;
  minVolRatio 0.01;
  minTriangleTwist -1;
  nSmoothScale 4;
  errorReduction 0.75;
}
mergeTolerance 1e-6;
)",
                        domain.most_cells, domain.levels, DistanceLevels(domain), Text(outside),
                        1e-9 * std::pow(domain.surface_cell, 3)));
}

std::string Control(const parametric::Air& air, double speed, int iterations) {
  return Dictionary("controlDict", absl::StrFormat(
                                       R"(application rhoSimpleFoam;
startFrom startTime;
startTime 0;
stopAt endTime;
endTime %d;
deltaT 1;
writeControl timeStep;
writeInterval %d;
purgeWrite 1;
writeFormat ascii;
writePrecision 9;
timeFormat general;
timePrecision 8;
runTimeModifiable false;
functions
{
  forces
  {
    type forces;
    libs (forces);
    patches (body);
    rho rho;
    pRef %.12g;
    CofR (0 0 0);
    writeControl timeStep;
    writeInterval 1;
    log false;
  }
  coefficient
  {
    type pressure;
    libs (fieldFunctionObjects);
    mode staticCoeff;
    result coefficient;
    rho rho;
    rhoInf %.12g;
    pInf %.12g;
    pRef 0;
    UInf %s;
    writeControl none;
  }
  body
  {
    type surfaces;
    libs (sampling);
    writeControl onEnd;
    surfaceFormat vtk;
    formatOptions { vtk { format ascii; legacy true; precision 12; } }
    fields (coefficient);
    interpolationScheme cell;
    surfaces ( body { type patch; patches (body); triangulate false; interpolate false; } );
  }
}
)",
                                       iterations, iterations, air.pressure, air.Density(),
                                       air.pressure, Text({speed, 0, 0})));
}

constexpr char kSchemes[] = R"(ddtSchemes { default steadyState; }
gradSchemes { default cellLimited Gauss linear 1; }
divSchemes
{
  default none;
  div(phi,U) bounded Gauss linearUpwind grad(U);
  div(phi,k) bounded Gauss upwind;
  div(phi,omega) bounded Gauss upwind;
  div(phi,h) bounded Gauss linearUpwind grad(h);
  div(phi,K) bounded Gauss linear;
  div(phi,Ekp) bounded Gauss linear;
  div(phid,p) Gauss upwind;
  div((phi|interpolate(rho)),p) bounded Gauss upwind;
  div(((rho*nuEff)*dev2(T(grad(U))))) Gauss linear;
}
laplacianSchemes { default Gauss linear limited 0.5; }
interpolationSchemes { default linear; }
snGradSchemes { default limited 0.5; }
wallDist { method meshWave; }
)";

constexpr char kSolution[] = R"foam(solvers
{
  p { solver GAMG; smoother GaussSeidel; tolerance 1e-9; relTol 0.05; }
  "(U|k|omega|h)" { solver smoothSolver; smoother symGaussSeidel; tolerance 1e-9; relTol 0.1; }
}
SIMPLE
{
  nNonOrthogonalCorrectors 0;
  consistent yes;
  pMinFactor 0.1;
  pMaxFactor 2;
}
relaxationFactors
{
  fields { p 1; rho 1; }
  equations { U 0.9; "(k|omega)" 0.7; h 0.9; }
}
)foam";

std::string Thermophysics(const parametric::Air& air) {
  return Dictionary("thermophysicalProperties",
                    absl::StrFormat(R"(thermoType
{
  type hePsiThermo;
  mixture pureMixture;
  transport const;
  thermo hConst;
  equationOfState perfectGas;
  specie specie;
  energy sensibleEnthalpy;
}
mixture
{
  specie { molWeight %.12g; }
  thermodynamics { Cp %.12g; Hf 0; }
  transport { mu %.12g; Pr %.12g; }
}
)",
                                    parametric::kMolarMassOfAir, parametric::kHeatCapacityOfAir,
                                    air.Viscosity(), kPrandtl));
}

// Far beyond what air does below the speed of sound; keeps the first iterations in hand.
std::string Limits(const parametric::Air& air) {
  return Dictionary(
      "fvOptions",
      absl::StrFormat("limits { type limitTemperature; active yes; selectionMode all; min %.9g; "
                      "max %.9g; }\n",
                      0.5 * air.temperature, 1.5 * air.temperature));
}

std::string Stl(const mesh::SurfaceMesh& body) {
  std::string text = "solid body\n";
  for (Eigen::Index t = 0; t < body.triangles.cols(); ++t) {
    absl::StrAppend(&text, "facet normal 0 0 0\nouter loop\n");
    for (const int v : body.triangles.col(t)) {
      const Eigen::Vector3d p = body.vertices.col(v);
      absl::StrAppendFormat(&text, "vertex %.12g %.12g %.12g\n", p.x(), p.y(), p.z());
    }
    absl::StrAppend(&text, "endloop\nendfacet\n");
  }
  return text + "endsolid body\n";
}

}  // namespace

AirflowDomain MakeAirflowDomain(const mesh::SurfaceMesh& body, int cells) {
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(body.vertices.rowwise().minCoeff()),
                                   Eigen::Vector3d(body.vertices.rowwise().maxCoeff()));
  const double extent = bounds.sizes().maxCoeff();
  const Eigen::Vector3d wanted =
      extent * Eigen::Vector3d(kBefore + kBehind, 2 * kBeside, 2 * kBeside);
  const double area = mesh::SurfaceArea(body);
  AirflowDomain domain;
  domain.most_cells = kMaxCellsOverWanted * std::max(cells, 10'000);
  double coarse = 0;
  // Cells far off and cells at the body add up to those wanted; the ones follow from the others.
  double at_body = cells;
  for (int round = 0; round < 5; ++round) {
    domain.surface_cell = std::sqrt(kCellsPerSurfaceCell * area / at_body);
    domain.levels =
        std::max(1, static_cast<int>(std::ceil(std::log2(0.5 * extent / domain.surface_cell))));
    coarse = domain.surface_cell * std::exp2(domain.levels);
    at_body = std::max(0.5 * cells, cells - wanted.prod() / std::pow(coarse, 3));
  }
  domain.divisions = (wanted.array() / coarse).ceil().cast<int>();
  const Eigen::Vector3d size = coarse * domain.divisions.cast<double>().matrix();
  // A little off, so that no face of a cell lies in a flat face of the body.
  const Eigen::Vector3d low = bounds.center() -
                              Eigen::Vector3d(kBefore * extent, size.y() / 2, size.z() / 2) +
                              Eigen::Vector3d::Constant(0.013 * coarse);
  domain.box = Eigen::AlignedBox3d(low, low + size);
  return domain;
}

std::map<std::string, std::string> WriteAirflowCase(const mesh::SurfaceMesh& body,
                                                    const AirflowDomain& domain,
                                                    const parametric::Air& air, double speed,
                                                    int iterations) {
  std::map<std::string, std::string> files{
      {"constant/triSurface/body.stl", Stl(body)},
      {"constant/thermophysicalProperties", Thermophysics(air)},
      {"constant/fvOptions", Limits(air)},
      {"constant/turbulenceProperties",
       Dictionary(
           "turbulenceProperties",
           "simulationType RAS;\nRAS { RASModel kOmegaSST; turbulence on; printCoeffs off; }\n")},
      {"system/blockMeshDict", BlockMesh(domain)},
      {"system/snappyHexMeshDict", SnappyHexMesh(domain)},
      {"system/controlDict", Control(air, speed, iterations)},
      {"system/fvSchemes", Dictionary("fvSchemes", kSchemes)},
      {"system/fvSolution", Dictionary("fvSolution", kSolution)}};
  AddFields(domain, air, speed, files);
  return files;
}

}  // namespace mortise::simulator
