// Expressions of named parameters, such as "length / 2 - 0.03", with exact derivatives, and
// conditions, such as "length > 1.2 and armrests == 'both'".
//
// Grammar, by rising precedence; all operators group to the left except ^:
//   either     = both       { "or" both }
//   both       = negation   { "and" negation }
//   negation   = "not" negation | comparison
//   comparison = sum        [ ("==" | "!=" | "<" | "<=" | ">" | ">=") sum ]
//   sum        = product    { ("+" | "-") product }
//   product    = unary      { ("*" | "/") unary }
//   unary      = [ "-" | "+" ] unary | power
//   power      = primary    [ "^" unary ]                     -2^2 is -4, 2^3^2 is 2^9
//   primary    = number | name | quoted | "pi" | function "(" either { "," either } ")"
//              | "if" "(" either "," either "," either ")" | "(" either ")"
//              | ground "(" quoted { "," either } ")"
// Functions: sqrt sin cos tan floor ceil abs (one argument), min max (two or more). Angles in rad.
// Ground: terrain('name', x, y) is its height there, terrain_slope('name', x, y) how steeply it
// rises, terrain_lowest('name', x_from, x_to, y_from, y_to) and terrain_highest(…) its extremes
// under a rectangle (common/terrain/height_field.h); all in metres, but the slope, a plain number.
// Numbers as in C ("0.03", "1e-3"); names are a letter or underscore, then letters, digits,
// underscores.
//
// Numbers and conditions are told apart: what is compared, added or given to a function is a
// number; "and", "or", "not" and the first argument of "if" take conditions; both other arguments
// of "if" are numbers, or both are conditions. Of "and", "or" and "if" only what decides is
// evaluated, so that "if(n > 0, length / n, 0)" has a value where n is 0. A name that is a choice
// is compared, by == and !=, with one of its values in quotes, and used in no other way; so is one
// that is ground, the first argument of a function of ground in quotes. Equality of numbers is
// exact.
//
// Numbers take the unit that is needed. Where units of names are known, to compare metres with
// kilograms is a mistake, and so is an "if" between the two.
//
// An expression is parsed once into a flat program for a stack machine and can then be evaluated
// any number of times, from any number of threads. Derivatives are by forward-mode automatic
// differentiation and exact; at the kinks of abs, min, max, floor and ceil, at edges of ground, and
// where the condition of an "if" changes, they are those of the branch that was taken.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/expressions/expression_name.h"

namespace mortise::parametric {

// A number with its derivatives with respect to all parameters.
struct Dual {
  double value = 0;
  Eigen::VectorXd gradient;  // one entry a parameter
};

class Expression {
 public:
  // Longest text, deepest nesting and most operations that are accepted.
  static constexpr std::size_t kMaxLength = 2048;
  static constexpr int kMaxDepth = 64;

  // Parses a number, `text`, whose names are among `parameters`: the parameters, and ground among
  // them or after them. INVALID_ARGUMENT with the column (counted from 1) and what was expected
  // there.
  static absl::StatusOr<Expression> Parse(std::string_view text,
                                          const std::vector<ExpressionName>& parameters);
  // As above, of parameters that are numbers in units that nobody knows.
  static absl::StatusOr<Expression> Parse(std::string_view text,
                                          const std::vector<std::string>& parameters);

  // Parses a condition; fails as Parse, and where `text` is a number.
  static absl::StatusOr<Expression> ParseCondition(std::string_view text,
                                                   const std::vector<ExpressionName>& parameters);

  // Returns the value at `q` (one entry a parameter, none for ground, in the order given to Parse;
  // of a choice the number of its value). INVALID_ARGUMENT naming the expression where it divides
  // by zero, leaves the domain of a function, asks for ground where that is not known, or is not
  // finite.
  absl::StatusOr<double> Value(const Eigen::Ref<const Eigen::VectorXd>& q) const;

  // As Value, with the gradient. Also fails where the gradient is not finite, as of sqrt at 0.
  absl::StatusOr<Dual> ValueAndGradient(const Eigen::Ref<const Eigen::VectorXd>& q) const;

  // Returns whether a condition holds at `q`; fails as Value.
  absl::StatusOr<bool> Holds(const Eigen::Ref<const Eigen::VectorXd>& q) const;

  const std::string& text() const { return text_; }

  // Whether its value changes with the parameter of this index, perhaps.
  bool Uses(int parameter) const;

 private:
  friend class ExpressionParser;
  enum class Operation : std::uint8_t;
  struct Instruction {
    Operation operation;
    // Of kParameter; of a jump, the instruction that comes next; of ground, which of `grounds_`.
    int parameter = 0;
    double constant = 0;  // of kConstant
  };

  // Ground that is asked for, by its name.
  struct NamedGround {
    std::string name;
    std::shared_ptr<const terrain::HeightField> heights;
  };

  // Runs the program; the gradient has `rows` entries, all parameters or none.
  absl::StatusOr<Dual> Run(const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::Index rows) const;

  // Returns what ground is asked for, with its derivatives by the operands, two or four.
  absl::StatusOr<Dual> AskGround(const Instruction& instruction,
                                 const Eigen::Ref<const Eigen::VectorXd>& operands) const;

  std::string text_;
  std::size_t parameter_count_ = 0;
  int stack_size_ = 0;
  std::vector<Instruction> program_;
  std::vector<NamedGround> grounds_;
};

}  // namespace mortise::parametric
