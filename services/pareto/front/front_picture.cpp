// Three panels and a legend.
#include "services/pareto/front/front_picture.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/render/axis_numbers.h"
#include "common/render/chart.h"
#include "services/pareto/archive/embedding.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using render::Color;
using render::Drawing;
using render::Frame;

constexpr int kWidth = 1320, kHeight = 520;
constexpr double kPanelWidth = 400, kPanelHeight = 372, kPanelTop = 76, kPanelGap = 34;
constexpr double kFont = 13, kSmallFont = 11;
constexpr int kColouredPieces = 11, kListedPieces = 7;
constexpr Index kDrawnLines = 250;  // of parallel axes
constexpr double kBarReach =
    0.01;  // of a point of the bar, to either side, unless others are nearer
constexpr double kVarying = 0.01;  // of a parameter's range
constexpr double kDarkJump = 0.2;  // where nothing jumps further, this would be darkest
constexpr double kDarkest = 0.75;  // mixture with black
constexpr Color kInk{0.125, 0.137, 0.165}, kGrid{0.86, 0.87, 0.89}, kRest{0.62, 0.62, 0.62};

// What values span, a little more than nothing.
struct Span {
  double least = 0, most = 1;

  explicit Span(const Eigen::Ref<const Eigen::RowVectorXd>& values)
      : least(values.minCoeff()), most(values.maxCoeff()) {
    const double size = std::max(std::abs(least), std::abs(most));
    if (most - least > 1e-9 * size) return;
    const double room = size > 0 ? 0.1 * size : 1;
    least -= room;
    most += room;
  }

  double Share(double value) const { return (value - least) / (most - least); }
  // Of the least and of the most.
  std::vector<std::string> Ends() const { return render::ShortNumbers({least, most}, 3); }
};

void Write(Drawing& drawing, const Vector2d& at, const std::string& text, double size = kFont,
           Drawing::Anchor anchor = Drawing::Anchor::kStart) {
  drawing.Add(Drawing::Text{at, text, size, anchor, kInk});
}

std::string LabelOf(const FrontPicture& front, Index metric) {
  const auto i = static_cast<std::size_t>(metric);
  const std::string& unit = front.metric_units[i];
  return unit.empty() ? front.metric_names[i]
                      : absl::StrCat(front.metric_names[i], " (", unit, ")");
}

// Pieces by size, the largest first, and the colour of each point.
struct Colours {
  std::vector<std::pair<int, int>> pieces;  // points, piece
  std::vector<Color> of_points;

  explicit Colours(const FrontPicture& front) {
    std::vector<int> sizes(1 + static_cast<std::size_t>(std::ranges::max(front.piece)), 0);
    for (const int piece : front.piece) ++sizes[static_cast<std::size_t>(piece)];
    for (std::size_t piece = 0; piece < sizes.size(); ++piece) {
      if (sizes[piece] > 0) pieces.emplace_back(sizes[piece], static_cast<int>(piece));
    }
    std::ranges::stable_sort(pieces,
                             [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Color> hues(sizes.size(), kRest);
    for (std::size_t rank = 0; rank < pieces.size(); ++rank) {
      hues[static_cast<std::size_t>(pieces[rank].second)] = Hue(rank);
    }
    const double darkest = std::max(front.jump.maxCoeff(), kDarkJump);
    for (std::size_t i = 0; i < front.piece.size(); ++i) {
      const double share = front.jump[static_cast<Index>(i)] / darkest;
      of_points.push_back(Mix(hues[static_cast<std::size_t>(front.piece[i])], {0, 0, 0},
                              kDarkest * std::clamp(share, 0.0, 1.0)));
    }
  }

  static Color Hue(std::size_t rank) {
    return rank < kColouredPieces ? render::PartColor(static_cast<int>(rank)) : kRest;
  }
};

// Discs at places of a panel, in the order given.
void DrawPoints(Drawing& drawing, const std::vector<Vector2d>& places, const Colours& colours,
                const std::vector<Index>& order) {
  const double radius = order.size() > 1500 ? 1.8 : order.size() > 300 ? 2.4 : 3.4;
  for (const Index i : order) {
    drawing.Add(Drawing::Disc{places[static_cast<std::size_t>(i)], radius,
                              colours.of_points[static_cast<std::size_t>(i)]});
  }
}

std::vector<Index> InOrder(Index count) {
  std::vector<Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), Index{0});
  return order;
}

// Points of the plane on two axes.
void DrawScatter(Drawing& drawing, const Frame& whole, const MatrixXd& values,
                 const std::string& x_label, const std::string& y_label, const Colours& colours) {
  const Span x(values.row(0)), y(values.row(1));
  const render::Axes axes(whole, {x.least, x.most}, {y.least, y.most});
  axes.Draw(drawing, x_label, y_label);
  std::vector<Vector2d> places;
  for (Index i = 0; i < values.cols(); ++i) places.push_back(axes.At(values(0, i), values(1, i)));
  DrawPoints(drawing, places, colours, InOrder(values.cols()));
}

// Points of space within a box, looked at along its diagonal from (1, 1, 1).
void DrawBox(Drawing& drawing, const Frame& whole, const MatrixXd& values,
             const std::vector<std::string>& labels, const Colours& colours) {
  const Frame panel = whole.Within(20, 20, 24, 44);
  const double size = std::min(panel.height / 2, panel.width / std::sqrt(3.0));
  const Vector2d origin = panel.Middle();
  const auto place = [&](double x, double y, double z) -> Vector2d {
    return origin + size * Vector2d((x - y) * std::sqrt(0.75), 0.5 * (x + y) - z);
  };
  for (const double part : {0.0, 0.5, 1.0}) {
    drawing.Add(Drawing::Line{{place(part, 1, 0), place(part, 0, 0), place(part, 0, 1)}, kGrid, 1});
    drawing.Add(Drawing::Line{{place(1, part, 0), place(0, part, 0), place(0, part, 1)}, kGrid, 1});
    drawing.Add(Drawing::Line{{place(1, 0, part), place(0, 0, part), place(0, 1, part)}, kGrid, 1});
  }
  drawing.Add(
      Drawing::Line{{place(0, 1, 1), place(0, 1, 0), place(1, 1, 0), place(1, 0, 0)}, kInk, 1});
  const Span x(values.row(0)), y(values.row(1)), z(values.row(2));
  const auto number = [&](const Vector2d& at, const std::string& text, Drawing::Anchor anchor) {
    Write(drawing, at, text, kSmallFont, anchor);
  };
  number(place(0, 1, 0) + Vector2d(2, 17), x.Ends()[0], Drawing::Anchor::kEnd);
  number(place(1, 1, 0) + Vector2d(-12, 11), x.Ends()[1], Drawing::Anchor::kEnd);
  number(place(1, 0, 0) + Vector2d(-2, 17), y.Ends()[0], Drawing::Anchor::kStart);
  number(place(1, 1, 0) + Vector2d(12, 11), y.Ends()[1], Drawing::Anchor::kStart);
  number(place(0, 1, 0) + Vector2d(-5, 0), z.Ends()[0], Drawing::Anchor::kEnd);
  number(place(0, 1, 1) + Vector2d(-5, 4), z.Ends()[1], Drawing::Anchor::kEnd);
  const double room = 0.49 * whole.width;
  Write(drawing, {whole.left, whole.top + whole.height - 4},
        render::Shortened(labels[0], kFont, room));
  Write(drawing, {whole.left + whole.width, whole.top + whole.height - 4},
        render::Shortened(labels[1], kFont, room), kFont, Drawing::Anchor::kEnd);
  Write(drawing, {whole.left, whole.top + 12}, render::Shortened(labels[2], kFont, whole.width));
  std::vector<Vector2d> places;
  VectorXd nearness(values.cols());
  for (Index i = 0; i < values.cols(); ++i) {
    const double a = x.Share(values(0, i)), b = y.Share(values(1, i)), c = z.Share(values(2, i));
    places.push_back(place(a, b, c));
    nearness[i] = a + b + c;
  }
  std::vector<Index> order = InOrder(values.cols());
  std::ranges::stable_sort(order, [&](Index a, Index b) { return nearness[a] < nearness[b]; });
  DrawPoints(drawing, places, colours, order);
}

// An upright axis for each metric, and a line through the values of each point.
void DrawParallelAxes(Drawing& drawing, const Frame& whole, const FrontPicture& front,
                      const Colours& colours) {
  const Frame panel = whole.Within(24, 24, 62, 22);
  const Index d = front.metrics.rows(), count = front.metrics.cols();
  std::vector<Span> spans;
  for (Index m = 0; m < d; ++m) spans.emplace_back(front.metrics.row(m));
  const auto across = [&](Index m) { return static_cast<double>(m) / static_cast<double>(d - 1); };
  const auto height = [&](Index m, double value) {
    const double share = spans[static_cast<std::size_t>(m)].Share(value);
    return front.signs[m] > 0 ? share : 1 - share;
  };
  // Draws some of many points, among them the best and the worst of each metric.
  const Index step = std::max<Index>(1, (count + kDrawnLines - 1) / kDrawnLines);
  std::set<Index> drawn;
  for (Index i = 0; i < count; i += step) drawn.insert(i);
  for (Index m = 0; m < d; ++m) {
    const auto [least, most] =
        std::ranges::minmax(InOrder(count), {}, [&](Index i) { return front.metrics(m, i); });
    drawn.insert({least, most});
  }
  for (const Index i : drawn) {
    Drawing::Line line{{}, colours.of_points[static_cast<std::size_t>(i)], 0.7};
    for (Index m = 0; m < d; ++m) {
      line.points.push_back(panel.At(across(m), height(m, front.metrics(m, i))));
    }
    drawing.Add(std::move(line));
  }
  for (Index m = 0; m < d; ++m) {
    drawing.Add(Drawing::Line{{panel.At(across(m), 0), panel.At(across(m), 1)}, kInk, 1});
    const Span& span = spans[static_cast<std::size_t>(m)];
    const bool is_small_best = front.signs[m] > 0;
    const Drawing::Anchor anchor = m == 0       ? Drawing::Anchor::kStart
                                   : m + 1 == d ? Drawing::Anchor::kEnd
                                                : Drawing::Anchor::kMiddle;
    const double shift = m == 0 ? -24 : m + 1 == d ? 24 : 0;
    const Vector2d top = panel.At(across(m), 1), bottom = panel.At(across(m), 0);
    const std::vector<std::string> ends = span.Ends();
    Write(drawing, top + Vector2d(shift, -6), ends[is_small_best ? 1 : 0], kSmallFont, anchor);
    Write(drawing, bottom + Vector2d(shift, 15), ends[is_small_best ? 0 : 1], kSmallFont, anchor);
    // Names of neighbours in two rows.
    const double between = panel.width / static_cast<double>(d - 1);
    const double room = m == 0 || m + 1 == d ? std::abs(shift) + 1.05 * between : 1.8 * between;
    Write(drawing, {top.x() + shift, whole.top + (m % 2 == 0 ? 12 : 30)},
          render::Shortened(LabelOf(front, m), kFont, room), kFont, anchor);
  }
}

void DrawPerformance(Drawing& drawing, const Frame& panel, const FrontPicture& front,
                     const Colours& colours) {
  const Index d = front.metrics.rows();
  if (d == 2) {
    return DrawScatter(drawing, panel, front.metrics, LabelOf(front, 0), LabelOf(front, 1),
                       colours);
  }
  if (d > 3) return DrawParallelAxes(drawing, panel, front, colours);
  DrawBox(drawing, panel, front.metrics, {LabelOf(front, 0), LabelOf(front, 1), LabelOf(front, 2)},
          colours);
}

// The parameters that vary along the front by more than `least` of their ranges.
std::vector<Index> Varying(const FrontPicture& front, double least) {
  std::vector<Index> varying;
  for (Index i = 0; i < front.parameters.rows(); ++i) {
    const auto values = front.parameters.row(i);
    if (values.maxCoeff() - values.minCoeff() > least * front.parameter_ranges[i]) {
      varying.push_back(i);
    }
  }
  return varying;
}

// The first two principal components of designs, with each parameter in units of its range, 2 x n.
MatrixXd PrincipalComponents(const FrontPicture& front, const std::vector<Index>& parameters,
                             std::vector<std::string>& labels) {
  MatrixXd u = front.parameter_ranges(parameters).cwiseInverse().asDiagonal() *
               front.parameters(parameters, Eigen::all);
  u.colwise() -= u.rowwise().mean().eval();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(u * u.transpose());
  const VectorXd& sizes = solver.eigenvalues();  // ascending
  MatrixXd components(2, u.cols());
  for (Index k = 0; k < 2; ++k) {
    const Index column = sizes.size() - 1 - k;
    VectorXd direction = solver.eigenvectors().col(column);
    Index most = 0;
    direction.cwiseAbs().maxCoeff(&most);
    if (direction[most] < 0) direction = -direction;  // its sign means nothing
    components.row(k) = direction.transpose() * u;
    labels.push_back(absl::StrFormat(
        "component %d, mostly %s: %.0f %%", k + 1,
        front.parameter_names[static_cast<std::size_t>(parameters[static_cast<std::size_t>(most)])],
        100 * sizes[column] / sizes.sum()));
  }
  return components;
}

void DrawDesigns(Drawing& drawing, const Frame& panel, const FrontPicture& front,
                 const Colours& colours) {
  std::vector<Index> varying = Varying(front, kVarying);
  if (varying.empty()) varying = Varying(front, 0);
  std::vector<std::string> labels;
  for (const Index i : varying) {
    labels.push_back(front.parameter_names[static_cast<std::size_t>(i)]);
  }
  if (varying.empty()) {
    Write(drawing, panel.Middle(), "all the same design", kFont, Drawing::Anchor::kMiddle);
  } else if (varying.size() == 1) {
    // Along the front, so that what jumps is seen.
    MatrixXd values(2, front.parameters.cols());
    values.row(0) = front.metrics.row(0);
    values.row(1) = front.parameters.row(varying[0]);
    DrawScatter(drawing, panel, values, LabelOf(front, 0), labels[0], colours);
  } else if (varying.size() == 2) {
    DrawScatter(drawing, panel, front.parameters(varying, Eigen::all), labels[0], labels[1],
                colours);
  } else if (varying.size() == 3) {
    DrawBox(drawing, panel, front.parameters(varying, Eigen::all), labels, colours);
  } else {
    labels.clear();
    const MatrixXd components = PrincipalComponents(front, varying, labels);
    DrawScatter(drawing, panel, components, labels[0], labels[1], colours);
  }
}

std::string Best(const FrontPicture& front, Index metric) {
  return absl::StrCat("best ", front.metric_names[static_cast<std::size_t>(metric)]);
}

// A stripe for each point, from where the first metric is worst to where it is best: half way to
// its neighbours, but where these are far away.
void DrawBar(Drawing& drawing, const Frame& whole, const FrontPicture& front,
             const Colours& colours) {
  const Frame bar = whole.Within(16, 16, 0.36 * whole.height, 0.36 * whole.height);
  drawing.Add(Drawing::Area{{bar.At(0, 0), bar.At(1, 0), bar.At(1, 1), bar.At(0, 1)}, kGrid});
  std::vector<Index> order = InOrder(front.embedding.cols());
  std::ranges::stable_sort(order, {}, [&](Index i) { return front.embedding(0, i); });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double x = front.embedding(0, order[k]);
    double from = std::max(0.0, x - kBarReach), to = std::min(1.0, x + kBarReach);
    if (k > 0) from = std::max(from, 0.5 * (x + front.embedding(0, order[k - 1])));
    if (k + 1 < order.size()) to = std::min(to, 0.5 * (x + front.embedding(0, order[k + 1])));
    drawing.Add(Drawing::Area{{bar.At(from, 0), bar.At(to, 0), bar.At(to, 1), bar.At(from, 1)},
                              colours.of_points[static_cast<std::size_t>(order[k])]});
  }
  const double room = 0.48 * whole.width;
  Write(drawing, bar.At(0, 0) + Vector2d(0, 20), render::Shortened(Best(front, 1), kFont, room));
  Write(drawing, bar.At(1, 0) + Vector2d(0, 20), render::Shortened(Best(front, 0), kFont, room),
        kFont, Drawing::Anchor::kEnd);
}

// Each point between the corners, which are the axes of performance, by its part of each.
void DrawTriangle(Drawing& drawing, const Frame& whole, const FrontPicture& front,
                  const Colours& colours) {
  const Frame panel = whole.Within(30, 30, 30, 40);
  const double side = std::min(panel.width, panel.height / std::sqrt(0.75));
  const Vector2d middle = panel.At(0.5, 0);
  const std::vector<Vector2d> corners = {middle + Vector2d(-0.5 * side, 0),
                                         middle + Vector2d(0.5 * side, 0),
                                         middle + Vector2d(0, -side * std::sqrt(0.75))};
  drawing.Add(Drawing::Line{{corners[0], corners[1], corners[2], corners[0]}, kInk, 1});
  const MatrixXd rays = RaysAt(front.embedding);
  std::vector<Vector2d> places;
  for (Index i = 0; i < rays.cols(); ++i) {
    const VectorXd part = rays.col(i) / rays.col(i).sum();
    places.emplace_back(part[0] * corners[0] + part[1] * corners[1] + part[2] * corners[2]);
  }
  DrawPoints(drawing, places, colours, InOrder(rays.cols()));
  // Opposite to its corner a metric is at its best.
  const double room = 0.4 * whole.width;
  Write(drawing, middle + Vector2d(0, 24), render::Shortened(Best(front, 2), kFont, whole.width),
        kFont, Drawing::Anchor::kMiddle);
  const double beside = 0.5 * (corners[0].y() + corners[2].y()) - 0.22 * side;
  Write(drawing, {whole.left, beside}, render::Shortened(Best(front, 1), kFont, room));
  Write(drawing, {whole.left + whole.width, beside}, render::Shortened(Best(front, 0), kFont, room),
        kFont, Drawing::Anchor::kEnd);
}

// Between the corners of a regular polygon by how good each metric is.
void DrawPolygon(Drawing& drawing, const Frame& whole, const FrontPicture& front,
                 const Colours& colours) {
  const Frame panel = whole.Within(20, 20, 46, 30);
  const Index d = front.metrics.rows();
  const double radius = 0.44 * std::min(panel.width, panel.height);
  std::vector<Vector2d> corners;
  for (Index m = 0; m < d; ++m) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(m) / static_cast<double>(d);
    corners.emplace_back(panel.Middle() + radius * Vector2d(std::sin(angle), -std::cos(angle)));
  }
  Drawing::Points outline = corners;
  outline.push_back(corners.front());
  drawing.Add(Drawing::Line{std::move(outline), kInk, 1});
  std::vector<Vector2d> places(static_cast<std::size_t>(front.metrics.cols()), Vector2d::Zero());
  VectorXd sums = VectorXd::Zero(front.metrics.cols());
  for (Index m = 0; m < d; ++m) {
    const Span span(front.metrics.row(m));
    for (Index i = 0; i < front.metrics.cols(); ++i) {
      const double share = span.Share(front.metrics(m, i));
      const double good = std::pow(front.signs[m] > 0 ? 1 - share : share, 4) + 1e-9;
      places[static_cast<std::size_t>(i)] += good * corners[static_cast<std::size_t>(m)];
      sums[i] += good;
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i) places[i] /= sums[static_cast<Index>(i)];
  DrawPoints(drawing, places, colours, InOrder(front.metrics.cols()));
  for (Index m = 0; m < d; ++m) {
    const Vector2d& corner = corners[static_cast<std::size_t>(m)];
    const Vector2d from = corner - panel.Middle();
    const bool is_beside = std::abs(from.x()) > 0.2 * radius;
    const Drawing::Anchor anchor = !is_beside     ? Drawing::Anchor::kMiddle
                                   : from.x() > 0 ? Drawing::Anchor::kEnd
                                                  : Drawing::Anchor::kStart;
    if (!is_beside) {
      Write(drawing, corner + Vector2d(0, from.y() > 0 ? 22 : -10),
            render::Shortened(Best(front, m), kFont, whole.width), kFont, anchor);
      continue;
    }
    // In two lines, beside the outline.
    const double x = from.x() > 0 ? whole.left + whole.width : whole.left;
    const double room = 0.5 * whole.width - std::abs(from.x()) - 6;
    const double y = corner.y() + (from.y() > 0.2 * radius ? 12 : -22);
    Write(drawing, {x, y}, "best", kFont, anchor);
    Write(drawing, {x, y + 16},
          render::Shortened(front.metric_names[static_cast<std::size_t>(m)], kFont, room), kFont,
          anchor);
  }
}

void DrawEmbedding(Drawing& drawing, const Frame& panel, const FrontPicture& front,
                   const Colours& colours) {
  const Index d = front.metrics.rows();
  if (d == 2) return DrawBar(drawing, panel, front, colours);
  if (d == 3) return DrawTriangle(drawing, panel, front, colours);
  DrawPolygon(drawing, panel, front, colours);
}

void DrawLegend(Drawing& drawing, const Colours& colours) {
  double x = 30;
  const double y = kHeight - 22;
  const auto entry = [&](const Color& color, const std::string& text) {
    drawing.Add(Drawing::Disc{{x, y - 4}, 5, color});
    Write(drawing, {x + 11, y}, text);
    x += 150;
  };
  std::size_t listed = std::min<std::size_t>(colours.pieces.size(), kListedPieces);
  if (colours.pieces.size() == listed + 1) ++listed;  // rather than "1 other"
  for (std::size_t rank = 0; rank < listed; ++rank) {
    const auto& [points, piece] = colours.pieces[rank];
    entry(Colours::Hue(rank),
          absl::StrCat("piece ", piece, ": ", points, points == 1 ? " point" : " points"));
  }
  if (listed < colours.pieces.size()) {
    entry(kRest, absl::StrCat(colours.pieces.size() - listed, " smaller ones"));
  }
}

}  // namespace

render::Drawing DrawFront(const FrontPicture& front) {
  Drawing drawing(kWidth, kHeight);
  const Colours colours(front);
  Write(drawing, {30, 28}, render::Shortened(front.title, 16, kWidth - 60), 16);
  const auto panel = [&](int column, const char* name) {
    const double left = 30 + column * (kPanelWidth + kPanelGap);
    Write(drawing, {left, 56}, name, 14);
    return Frame{left, kPanelTop, kPanelWidth, kPanelHeight};
  };
  DrawDesigns(drawing, panel(0, "Designs"), front, colours);
  DrawPerformance(drawing, panel(1, "Performance"), front, colours);
  DrawEmbedding(drawing, panel(2, "Embedding"), front, colours);
  DrawLegend(drawing, colours);
  return drawing;
}

}  // namespace mortise::pareto
