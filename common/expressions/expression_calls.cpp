// What the grammar of expressions calls: "if", functions, and functions of ground.
#include <algorithm>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/expressions/expression_parser.h"

namespace mortise::parametric {

// The condition, a jump over the first branch, that branch, a jump over the second one, and that.
ExpressionParser::Parsed ExpressionParser::ParseIf(std::size_t column) {
  MORTISE_ASSIGN_OR_RETURN(const Term condition, ParseEither());
  MORTISE_RETURN_IF_ERROR(Require(condition, Term::Kind::kCondition));
  Term result{.column = column};
  MORTISE_RETURN_IF_ERROR(ParseBranches(result));
  if (!Take(')')) return Fail("')'");
  return result;
}

absl::Status ExpressionParser::ParseBranches(Term& result) {
  const std::size_t over_first = Emit(Operation::kJumpUnless);
  if (!Take(',')) return Fail("','");
  MORTISE_ASSIGN_OR_RETURN(const Term first, ParseEither());
  if (first.kind != Term::Kind::kCondition) {
    MORTISE_RETURN_IF_ERROR(Require(first, Term::Kind::kNumber));
  }
  const std::size_t over_second = Emit(Operation::kJump);
  Land(over_first);
  --stack_;  // one of the branches leaves an operand
  if (!Take(',')) return Fail("','");
  MORTISE_ASSIGN_OR_RETURN(const Term second, ParseEither());
  MORTISE_RETURN_IF_ERROR(Require(second, first.kind));
  MORTISE_RETURN_IF_ERROR(CheckSameUnit(first, second));
  Land(over_second);
  result.kind = first.kind;
  result.dimension = CommonDimension(first.dimension, second.dimension);
  return absl::OkStatus();
}

ExpressionParser::Parsed ExpressionParser::ParseCall(std::string_view function,
                                                     std::size_t column) {
  struct GroundFunction {
    std::string_view name;
    Operation operation;
    int arguments;
  };
  static constexpr GroundFunction kGroundFunctions[] = {
      {"terrain", Operation::kGroundHeight, 2},
      {"terrain_slope", Operation::kGroundSlope, 2},
      {"terrain_lowest", Operation::kGroundLowest, 4},
      {"terrain_highest", Operation::kGroundHighest, 4},
  };
  for (const GroundFunction& entry : kGroundFunctions) {
    if (entry.name == function) return ParseGround(entry.operation, entry.arguments, column);
  }
  struct Function {
    std::string_view name;
    Operation operation;
    bool takes_many;
    bool keeps_unit;
  };
  static constexpr Function kFunctions[] = {
      {"sqrt", Operation::kSquareRoot, false, false}, {"sin", Operation::kSine, false, false},
      {"cos", Operation::kCosine, false, false},      {"tan", Operation::kTangent, false, false},
      {"floor", Operation::kFloor, false, true},      {"ceil", Operation::kCeiling, false, true},
      {"abs", Operation::kAbsolute, false, true},     {"min", Operation::kMinimum, true, true},
      {"max", Operation::kMaximum, true, true},
  };
  const auto* found =
      std::find_if(std::begin(kFunctions), std::end(kFunctions),
                   [function](const Function& entry) { return entry.name == function; });
  if (found == std::end(kFunctions)) {
    const std::string unknown(function);
    const auto name_of = [](const Function& entry) { return std::string(entry.name); };
    return FailAt(column, absl::StrCat("there is no function '", unknown, "'",
                                       NamesOffered(unknown, kFunctions, name_of)));
  }
  MORTISE_ASSIGN_OR_RETURN(Term result, ParseOperand(&ExpressionParser::ParseEither));
  int arguments = 1;
  while (found->takes_many && Take(',')) {
    MORTISE_ASSIGN_OR_RETURN(const Term other, ParseOperand(&ExpressionParser::ParseEither));
    result.dimension = CommonDimension(result.dimension, other.dimension);
    Emit(found->operation);
    ++arguments;
  }
  if (found->takes_many && arguments < 2) return Fail("','");
  if (!found->takes_many) Emit(found->operation);
  if (!Take(')')) return Fail("')'");
  result.column = column;
  if (!found->keeps_unit) result.dimension.reset();
  return result;
}

ExpressionParser::Parsed ExpressionParser::ParseGround(Operation operation, int arguments,
                                                       std::size_t column) {
  MORTISE_ASSIGN_OR_RETURN(const int ground, ParseGroundName());
  const Dimension metres = {{"m", 1}};
  for (int i = 0; i < arguments; ++i) {
    if (!Take(',')) return Fail("','");
    MORTISE_ASSIGN_OR_RETURN(const Term argument, ParseOperand(&ExpressionParser::ParseEither));
    if (argument.dimension && *argument.dimension != metres) {
      return FailAt(argument.column,
                    absl::StrCat("is in ", ToText(*argument.dimension), ", while places are in m"));
    }
  }
  if (!Take(')')) return Fail("')'");
  Emit(operation, ground);
  const bool is_slope = operation == Operation::kGroundSlope;
  return Term{.column = column, .dimension = is_slope ? Dimension{} : metres};
}

absl::StatusOr<int> ExpressionParser::ParseGroundName() {
  if (Peek() != '\'') return Fail("the name of ground in quotes");
  const std::size_t column = position_;
  MORTISE_ASSIGN_OR_RETURN(const std::string_view quoted, TakeQuoted());
  std::vector<std::string> known;
  for (const ExpressionName& name : names_) {
    if (name.ground == nullptr) continue;
    if (name.name == quoted) return GroundOf(name);
    known.push_back(name.name);
  }
  return FailAt(
      column,
      absl::StrCat("there is no ground '", std::string(quoted), "'; ",
                   known.empty() ? "there is none here"
                                 : absl::StrCat("there is '", absl::StrJoin(known, "', '"), "'")));
}

int ExpressionParser::GroundOf(const ExpressionName& name) {
  std::vector<Expression::NamedGround>& grounds = result_.grounds_;
  const auto found = std::find_if(
      grounds.begin(), grounds.end(),
      [&name](const Expression::NamedGround& ground) { return ground.name == name.name; });
  const auto index = static_cast<int>(found - grounds.begin());
  if (found == grounds.end()) grounds.push_back({name.name, name.ground});
  return index;
}

}  // namespace mortise::parametric
