#include "common/assembly/relations/equality_solver.h"

#include <Eigen/OrderingMethods>
#include <Eigen/QR>
#include <Eigen/SparseQR>
#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

#include "absl/hash/hash.h"

namespace mortise::parametric {
namespace {

using SparseColumns = Eigen::SparseMatrix<double>;

// Of unit equalities, what others leave of one that says nothing new: drawings are not more exact.
constexpr double kRankThreshold = 1e-6;
constexpr double kRounding = 1e-13;  // in products of orthonormal columns with unit rows
// Variables that are solved at once, whatever groups they belong to. What is smaller takes a few
// hundredths of a second.
constexpr std::size_t kMaxAtOnce = 600;

template <typename Number>
std::string_view BytesOf(const Number* numbers, Eigen::Index count) {
  return {reinterpret_cast<const char*>(numbers), static_cast<std::size_t>(count) * sizeof(Number)};
}

std::size_t HashOf(const SparseColumns& columns, bool is_reduced) {
  return absl::HashOf(is_reduced, columns.rows(), columns.cols(),
                      BytesOf(columns.innerIndexPtr(), columns.nonZeros()),
                      BytesOf(columns.valuePtr(), columns.nonZeros()));
}

bool AreSame(const SparseColumns& a, const SparseColumns& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         BytesOf(a.outerIndexPtr(), a.cols() + 1) == BytesOf(b.outerIndexPtr(), b.cols() + 1) &&
         BytesOf(a.innerIndexPtr(), a.nonZeros()) == BytesOf(b.innerIndexPtr(), b.nonZeros()) &&
         BytesOf(a.valuePtr(), a.nonZeros()) == BytesOf(b.valuePtr(), b.nonZeros());
}

template <typename Decomposition>
EqualitySolution SolutionOf(const Decomposition& qr, Eigen::Index rank, Eigen::Index unknowns) {
  EqualitySolution solution;
  for (Eigen::Index i = 0; i < rank; ++i) {
    solution.kept.push_back(static_cast<int>(qr.colsPermutation().indices()[i]));
  }
  solution.directions = Eigen::MatrixXd::Zero(unknowns, unknowns - rank);
  solution.directions.bottomRows(unknowns - rank).setIdentity();
  if (rank < unknowns) solution.directions = qr.matrixQ() * solution.directions;
  return solution;
}

EqualitySolution SolveSparse(const SparseColumns& equalities) {
  Eigen::SparseQR<SparseColumns, Eigen::COLAMDOrdering<int>> qr;
  qr.setPivotThreshold(kRankThreshold);
  qr.compute(equalities);
  return SolutionOf(qr, qr.rank(), equalities.rows());
}

EqualitySolution SolveDense(const SparseColumns& equalities) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr{Eigen::MatrixXd(equalities)};
  const auto pivots = qr.matrixQR().diagonal().cwiseAbs();
  Eigen::Index rank = 0;
  while (rank < pivots.size() && pivots[rank] >= kRankThreshold) ++rank;
  return SolutionOf(qr, rank, equalities.rows());
}

// Puts things into sets, as they turn out to be connected.
class Sets {
 public:
  explicit Sets(std::size_t count) : sets_(count) {}
  std::size_t Of(std::size_t one) { return sets_.find_set(one); }
  void Connect(std::size_t a, std::size_t b) { sets_.union_set(a, b); }

 private:
  boost::disjoint_sets_with_storage<> sets_;
};

double LengthOf(const LinearForm& form) {
  double squared = 0;
  for (const LinearTerm& term : form.terms) squared += term.coefficient * term.coefficient;
  return std::sqrt(squared);
}

// One block, group by group. Variables that have been solved together are a piece; each is one by
// itself to begin with.
class BlockByGroups {
 public:
  BlockByGroups(const EqualityBlock& block, const std::vector<int>& parents, EqualitySolver& solver)
      : parents_(parents), solver_(solver), is_raw_(block.variables.size(), true) {
    for (std::size_t i = 0; i < block.variables.size(); ++i) {
      pieces_.push_back({{block.variables[i]}, Eigen::MatrixXd::Identity(1, 1)});
      place_of_[block.variables[i]] = {i, 0};
    }
    for (const Relationship* equality : block.equalities) {
      by_group_[{-DepthOf(equality->group), equality->group}].push_back(equality);
    }
  }

  void Solve(SolvedEqualities& solved) {
    for (const auto& [group, equalities] : by_group_) {
      std::vector<const Relationship*> own, above;
      for (const Relationship* equality : equalities) {
        (IsRaw(*equality) ? own : above).push_back(equality);
      }
      SolveTogether(own, false);
      SolveTogether(above, true);
    }
    std::vector<FreeVariables> free;
    for (FreeVariables& piece : pieces_) {
      if (piece.directions.cols() > 0) free.push_back(std::move(piece));
    }
    std::sort(free.begin(), free.end(), [](const FreeVariables& a, const FreeVariables& b) {
      return a.variables.front() < b.variables.front();
    });
    std::move(free.begin(), free.end(), std::back_inserter(solved.free));
    solved.kept.insert(solved.kept.end(), kept_.begin(), kept_.end());
  }

 private:
  // An equality in the unknowns of the pieces that it speaks of.
  struct Row {
    const Relationship* equality = nullptr;
    std::map<std::size_t, Eigen::RowVectorXd> of_piece;
  };
  struct Place {
    std::size_t piece = 0;
    Eigen::Index row = 0;
  };

  // How many groups lie above a group, itself counted.
  int DepthOf(int group) const {
    int depth = 0;
    while (group != kAboveRoot) {
      group = parents_[static_cast<std::size_t>(group)];
      ++depth;
    }
    return depth;
  }

  // Whether all that the equality speaks of is as free as it was to begin with.
  bool IsRaw(const Relationship& equality) const {
    return std::all_of(
        equality.form.terms.begin(), equality.form.terms.end(),
        [&](const LinearTerm& term) { return is_raw_[place_of_.at(term.variable).piece]; });
  }

  Row RowOf(const Relationship& equality) const {
    Row row{&equality, {}};
    const double length = LengthOf(equality.form);
    for (const LinearTerm& term : equality.form.terms) {
      const Place& place = place_of_.at(term.variable);
      const FreeVariables& piece = pieces_[place.piece];
      Eigen::RowVectorXd& part =
          row.of_piece.try_emplace(place.piece, Eigen::RowVectorXd::Zero(piece.directions.cols()))
              .first->second;
      part += term.coefficient / length * piece.directions.row(place.row);
    }
    // Rounding must not tie together what has nothing to do with each other.
    std::erase_if(row.of_piece, [](const auto& part) {
      return part.second.size() == 0 || part.second.cwiseAbs().maxCoeff() <= kRounding;
    });
    return row;
  }

  static bool SaysSomething(const Row& row) {
    double squared = 0;
    for (const auto& [piece, part] : row.of_piece) squared += part.squaredNorm();
    return std::sqrt(squared) >= kRankThreshold;
  }

  void SolveTogether(const std::vector<const Relationship*>& equalities, bool is_reduced) {
    std::vector<Row> rows;
    Sets connected(pieces_.size());
    for (const Relationship* equality : equalities) {
      Row row = RowOf(*equality);
      if (!SaysSomething(row)) continue;
      for (const auto& [piece, part] : row.of_piece) {
        connected.Connect(row.of_piece.begin()->first, piece);
      }
      rows.push_back(std::move(row));
    }
    struct System {
      std::vector<std::size_t> pieces;
      std::vector<const Row*> rows;
    };
    std::map<std::size_t, System> systems;
    for (const Row& row : rows) {
      systems[connected.Of(row.of_piece.begin()->first)].rows.push_back(&row);
    }
    for (std::size_t piece = 0; piece < pieces_.size(); ++piece) {
      const auto system = systems.find(connected.Of(piece));
      if (system != systems.end()) system->second.pieces.push_back(piece);
    }
    for (const auto& [set, system] : systems) {
      SolveSystem(system.pieces, system.rows, is_reduced);
    }
  }

  void SolveSystem(const std::vector<std::size_t>& pieces, const std::vector<const Row*>& rows,
                   bool is_reduced) {
    std::map<std::size_t, Eigen::Index> first;  // unknown of each piece
    Eigen::Index unknowns = 0;
    for (const std::size_t piece : pieces) {
      first[piece] = unknowns;
      unknowns += pieces_[piece].directions.cols();
    }
    SparseColumns columns(unknowns, static_cast<Eigen::Index>(rows.size()));
    for (Eigen::Index column = 0; column < columns.cols(); ++column) {
      for (const auto& [piece, part] : rows[static_cast<std::size_t>(column)]->of_piece) {
        for (Eigen::Index i = 0; i < part.size(); ++i) {
          if (part[i] != 0) columns.insert(first.at(piece) + i, column) = part[i];
        }
      }
    }
    columns.makeCompressed();
    const auto solution = solver_.Solve(columns, is_reduced);
    for (const int kept : solution->kept) {
      kept_.push_back(rows[static_cast<std::size_t>(kept)]->equality);
    }
    Merge(pieces, first, solution->directions);
  }

  // Makes one piece of several, with these directions in the unknowns of all.
  void Merge(const std::vector<std::size_t>& pieces,
             const std::map<std::size_t, Eigen::Index>& first, const Eigen::MatrixXd& directions) {
    Eigen::Index size = 0;
    for (const std::size_t piece : pieces) size += pieces_[piece].directions.rows();
    FreeVariables made;
    made.directions.resize(size, directions.cols());
    Eigen::Index row = 0;
    for (const std::size_t index : pieces) {
      FreeVariables& piece = pieces_[index];
      const Eigen::Index rows = piece.directions.rows();
      made.directions.middleRows(row, rows) =
          piece.directions * directions.middleRows(first.at(index), piece.directions.cols());
      for (std::size_t i = 0; i < piece.variables.size(); ++i) {
        place_of_[piece.variables[i]] = {pieces.front(), row + static_cast<Eigen::Index>(i)};
      }
      made.variables.insert(made.variables.end(), piece.variables.begin(), piece.variables.end());
      row += rows;
      piece = {};
    }
    pieces_[pieces.front()] = std::move(made);
    is_raw_[pieces.front()] = false;
  }

  const std::vector<int>& parents_;
  EqualitySolver& solver_;
  std::vector<FreeVariables> pieces_;  // empty where another has taken it up
  std::vector<bool> is_raw_;           // of each piece
  std::map<int, Place> place_of_;      // of each variable
  // By depth, the deepest first, and index.
  std::map<std::pair<int, int>, std::vector<const Relationship*>> by_group_;
  std::vector<const Relationship*> kept_;
};

void SolveAtOnce(const EqualityBlock& block, EqualitySolver& solver, SolvedEqualities& solved) {
  const auto solution = solver.Solve(ColumnsOf(block), false);
  for (const int kept : solution->kept) {
    solved.kept.push_back(block.equalities[static_cast<std::size_t>(kept)]);
  }
  if (solution->directions.cols() > 0) {
    solved.free.push_back({block.variables, solution->directions});
  }
}

}  // namespace

const SolvedSystems::Entry* SolvedSystems::Find(std::size_t hash, bool is_reduced,
                                                const SparseColumns& equalities) const {
  const auto [first, last] = entries_.equal_range(hash);
  const auto found = std::find_if(first, last, [&](const auto& entry) {
    return entry.second.is_reduced == is_reduced && AreSame(entry.second.equalities, equalities);
  });
  return found == last ? nullptr : &found->second;
}

void SolvedSystems::Add(std::size_t hash, Entry entry) { entries_.emplace(hash, std::move(entry)); }

std::size_t SolvedSystems::MemoryUse() const {
  std::size_t bytes = sizeof(*this);
  for (const auto& [hash, entry] : entries_) {
    const auto nonzeros = static_cast<std::size_t>(entry.equalities.nonZeros());
    bytes += sizeof(entry) + sizeof(EqualitySolution) + nonzeros * (sizeof(double) + sizeof(int)) +
             static_cast<std::size_t>(entry.equalities.cols()) * sizeof(int) +
             entry.solution->kept.size() * sizeof(int) +
             static_cast<std::size_t>(entry.solution->directions.size()) * sizeof(double);
  }
  return bytes;
}

std::shared_ptr<const EqualitySolution> EqualitySolver::Solve(const SparseColumns& equalities,
                                                              bool is_reduced) {
  const std::size_t hash = HashOf(equalities, is_reduced);
  if (const auto* own = solved_->Find(hash, is_reduced, equalities)) return own->solution;
  SolvedSystems::Entry made{is_reduced, equalities, nullptr};
  for (const auto& known : known_) {
    const auto* entry = known == nullptr ? nullptr : known->Find(hash, is_reduced, equalities);
    if (entry == nullptr) continue;
    made.solution = entry->solution;
    break;
  }
  if (made.solution == nullptr) {
    made.solution = std::make_shared<const EqualitySolution>(is_reduced ? SolveDense(equalities)
                                                                        : SolveSparse(equalities));
  }
  const auto solution = made.solution;
  solved_->Add(hash, std::move(made));
  return solution;
}

SolvedEqualities SolveEqualities(const std::vector<Relationship>& relationships,
                                 const std::vector<int>& variables, const std::vector<int>& parents,
                                 EqualitySolver& solver) {
  SolvedEqualities solved;
  for (const EqualityBlock& block : SplitIntoBlocks(relationships, variables)) {
    if (block.equalities.empty()) {
      const auto size = static_cast<Eigen::Index>(block.variables.size());
      solved.free.push_back({block.variables, Eigen::MatrixXd::Identity(size, size)});
    } else if (parents.empty() || block.variables.size() <= kMaxAtOnce) {
      SolveAtOnce(block, solver, solved);
    } else {
      BlockByGroups(block, parents, solver).Solve(solved);
    }
  }
  return solved;
}

std::vector<EqualityBlock> SplitIntoBlocks(const std::vector<Relationship>& relationships,
                                           const std::vector<int>& variables) {
  int last = variables.empty() ? -1 : *std::max_element(variables.begin(), variables.end());
  for (const Relationship& relationship : relationships) {
    for (const LinearTerm& term : relationship.form.terms) last = std::max(last, term.variable);
  }
  Sets connected(static_cast<std::size_t>(last + 1));
  const auto set_of = [&](int variable) {
    return connected.Of(static_cast<std::size_t>(variable));
  };
  for (const Relationship& relationship : relationships) {
    if (!relationship.equality) continue;
    for (const LinearTerm& term : relationship.form.terms) {
      connected.Connect(set_of(relationship.form.terms.front().variable), set_of(term.variable));
    }
  }
  std::map<std::size_t, EqualityBlock> blocks;
  for (const int variable : variables) blocks[set_of(variable)].variables.push_back(variable);
  for (const Relationship& relationship : relationships) {
    if (!relationship.equality) continue;
    const std::size_t set = set_of(relationship.form.terms.front().variable);
    blocks[set].equalities.push_back(&relationship);
  }
  std::vector<EqualityBlock> result;
  for (auto& [set, block] : blocks) result.push_back(std::move(block));
  return result;
}

SparseColumns ColumnsOf(const EqualityBlock& block) {
  std::map<int, Eigen::Index> place;
  for (const int variable : block.variables) {
    place.emplace(variable, static_cast<Eigen::Index>(place.size()));
  }
  SparseColumns columns(static_cast<Eigen::Index>(block.variables.size()),
                        static_cast<Eigen::Index>(block.equalities.size()));
  for (Eigen::Index column = 0; column < columns.cols(); ++column) {
    const LinearForm& form = block.equalities[static_cast<std::size_t>(column)]->form;
    const double length = LengthOf(form);
    for (const LinearTerm& term : form.terms) {
      columns.insert(place.at(term.variable), column) = term.coefficient / length;
    }
  }
  columns.makeCompressed();
  return columns;
}

}  // namespace mortise::parametric
