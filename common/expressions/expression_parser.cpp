// The grammar of expressions, one function a rule.
#include "common/expressions/expression_parser.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/decimal_number.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"

namespace mortise::parametric {
namespace {

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

bool IsNameStart(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

// Counts nesting for as long as it is in scope.
class DepthScope {
 public:
  explicit DepthScope(int& depth) : depth_(depth) { ++depth_; }
  ~DepthScope() { --depth_; }
  DepthScope(const DepthScope&) = delete;
  DepthScope& operator=(const DepthScope&) = delete;

 private:
  int& depth_;
};

std::optional<Dimension> Product(const std::optional<Dimension>& a,
                                 const std::optional<Dimension>& b, double power) {
  if (!a || !b) return std::nullopt;
  Dimension product = *a;
  for (const auto& [symbol, exponent] : *b) {
    double& sum = product[symbol];
    sum += power * exponent;
    if (sum == 0) product.erase(symbol);
  }
  return product;
}

}  // namespace

std::optional<Dimension> CommonDimension(const std::optional<Dimension>& a,
                                         const std::optional<Dimension>& b) {
  if (!a) return b;
  if (!b || *a == *b) return a;
  return std::nullopt;
}

ExpressionParser::ExpressionParser(std::string_view text, const std::vector<ExpressionName>& names)
    : text_(text), names_(names) {}

absl::StatusOr<Expression> ExpressionParser::Parse(bool is_condition) {
  if (text_.size() > Expression::kMaxLength) {
    return absl::InvalidArgumentError(absl::StrCat("expression of ", text_.size(),
                                                   " characters; at most ", Expression::kMaxLength,
                                                   " are accepted"));
  }
  result_.text_ = std::string(text_);
  result_.parameter_count_ = static_cast<std::size_t>(NumberOf(static_cast<int>(names_.size())));
  MORTISE_ASSIGN_OR_RETURN(const Term whole, ParseEither());
  if (Peek() != '\0' || position_ < text_.size()) {
    return Fail(TakeComparison() ? "'and' or 'or', as one comparison follows another"
                                 : "an operator or the end");
  }
  MORTISE_RETURN_IF_ERROR(
      Require(whole, is_condition ? Term::Kind::kCondition : Term::Kind::kNumber));
  return std::move(result_);
}

// ---- Conditions ---------------------------------------------------------------------------------

ExpressionParser::Parsed ExpressionParser::ParseConditions(std::string_view word, Operation jump,
                                                           Parsed (ExpressionParser::*parse)()) {
  MORTISE_ASSIGN_OR_RETURN(Term term, (this->*parse)());
  std::vector<std::size_t> jumps;
  while (TakeWord(word)) {
    MORTISE_RETURN_IF_ERROR(Require(term, Term::Kind::kCondition));
    jumps.push_back(Emit(jump));
    MORTISE_ASSIGN_OR_RETURN(const Term other, (this->*parse)());
    MORTISE_RETURN_IF_ERROR(Require(other, Term::Kind::kCondition));
  }
  for (const std::size_t at : jumps) Land(at);
  return term;
}

ExpressionParser::Parsed ExpressionParser::ParseEither() {
  return ParseConditions("or", Operation::kJumpIf, &ExpressionParser::ParseBoth);
}

ExpressionParser::Parsed ExpressionParser::ParseBoth() {
  return ParseConditions("and", Operation::kJumpIfNot, &ExpressionParser::ParseNegation);
}

ExpressionParser::Parsed ExpressionParser::ParseNegation() {
  Peek();
  const std::size_t column = position_;
  if (FindName("not") >= 0 || !TakeWord("not")) return ParseComparison();
  const DepthScope scope(depth_);
  if (depth_ > Expression::kMaxDepth) {
    return Fail(absl::StrCat("at most ", Expression::kMaxDepth, " levels of nesting"));
  }
  MORTISE_ASSIGN_OR_RETURN(Term term, ParseNegation());
  MORTISE_RETURN_IF_ERROR(Require(term, Term::Kind::kCondition));
  Emit(Operation::kNot);
  term.column = column;
  return term;
}

ExpressionParser::Parsed ExpressionParser::ParseComparison() {
  MORTISE_ASSIGN_OR_RETURN(Term left, ParseSum());
  const std::optional<Operation> operation = TakeComparison();
  if (!operation) return left;
  MORTISE_ASSIGN_OR_RETURN(const Term right, ParseSum());
  const auto is_named = [](const Term& term) {
    return term.kind == Term::Kind::kChoice || term.kind == Term::Kind::kQuoted;
  };
  if (is_named(left) || is_named(right)) {
    MORTISE_RETURN_IF_ERROR(CompareChoice(left, right, *operation));
  } else {
    MORTISE_RETURN_IF_ERROR(Require(left, Term::Kind::kNumber));
    MORTISE_RETURN_IF_ERROR(Require(right, Term::Kind::kNumber));
    MORTISE_RETURN_IF_ERROR(CheckSameUnit(left, right));
  }
  Emit(*operation);
  return Term{.kind = Term::Kind::kCondition, .column = left.column};
}

std::optional<Expression::Operation> ExpressionParser::TakeComparison() {
  struct Comparison {
    std::string_view symbol;
    Operation operation;
  };
  static constexpr Comparison kComparisons[] = {
      {"==", Operation::kEqual},       {"!=", Operation::kNotEqual},
      {"<=", Operation::kLessOrEqual}, {">=", Operation::kGreaterOrEqual},
      {"<", Operation::kLess},         {">", Operation::kGreater}};
  Peek();
  for (const Comparison& comparison : kComparisons) {
    if (!text_.substr(position_).starts_with(comparison.symbol)) continue;
    position_ += comparison.symbol.size();
    return comparison.operation;
  }
  return std::nullopt;
}

absl::Status ExpressionParser::CompareChoice(const Term& left, const Term& right,
                                             Operation operation) {
  const bool turned = left.kind == Term::Kind::kQuoted;
  const Term& choice = turned ? right : left;
  const Term& value = turned ? left : right;
  if (choice.kind != Term::Kind::kChoice || value.kind != Term::Kind::kQuoted) {
    const bool is_choice = left.kind == Term::Kind::kChoice || right.kind == Term::Kind::kChoice;
    const Term& odd = left.kind == Term::Kind::kChoice ? right : left;
    return FailAt(odd.column,
                  is_choice ? "expected the name of a value in quotes, as a choice is compared"
                            : "expected a parameter that is a choice beside what is quoted");
  }
  const ExpressionName& parameter = names_[static_cast<std::size_t>(choice.choice)];
  if (operation != Operation::kEqual && operation != Operation::kNotEqual) {
    return FailAt(left.column, absl::StrCat("the values of '", parameter.name,
                                            "' have no order: only == and != compare them"));
  }
  const auto found = std::find(parameter.choices.begin(), parameter.choices.end(), value.quoted);
  if (found == parameter.choices.end()) {
    return FailAt(value.column,
                  absl::StrCat("'", parameter.name, "' has no value '", std::string(value.quoted),
                               "'; it has '", absl::StrJoin(parameter.choices, "', '"), "'"));
  }
  result_.program_[value.instruction].constant =
      static_cast<double>(found - parameter.choices.begin());
  return absl::OkStatus();
}

absl::Status ExpressionParser::CheckSameUnit(const Term& left, const Term& right) const {
  if (!left.dimension || !right.dimension || *left.dimension == *right.dimension) {
    return absl::OkStatus();
  }
  return FailAt(right.column,
                absl::StrCat("is in ", ToText(*right.dimension), ", while its counterpart is in ",
                             ToText(*left.dimension)));
}

absl::Status ExpressionParser::Require(const Term& term, Term::Kind kind) const {
  if (term.kind == kind) return absl::OkStatus();
  const std::string expected =
      kind == Term::Kind::kNumber
          ? "expected a number"
          : "expected a condition, such as a comparison, which is true or false";
  switch (term.kind) {
    case Term::Kind::kNumber:
      return FailAt(term.column, absl::StrCat(expected, ", not a number"));
    case Term::Kind::kCondition:
      return FailAt(term.column, absl::StrCat(expected, ", not a condition"));
    case Term::Kind::kChoice: {
      const ExpressionName& choice = names_[static_cast<std::size_t>(term.choice)];
      return FailAt(term.column, absl::StrCat(expected, "; '", choice.name,
                                              "' is a choice, to be compared with a value, as ",
                                              choice.name, " == '", choice.choices.front(), "'"));
    }
    case Term::Kind::kGround: {
      const std::string& ground = names_[static_cast<std::size_t>(term.choice)].name;
      return FailAt(term.column, absl::StrCat(expected, "; '", ground,
                                              "' is ground, to be asked for a height, as terrain('",
                                              ground, "', x, y)"));
    }
    case Term::Kind::kQuoted:
      break;
  }
  return FailAt(term.column,
                absl::StrCat(expected, "; what is quoted is compared with a choice only"));
}

// ---- Numbers ------------------------------------------------------------------------------------

ExpressionParser::Parsed ExpressionParser::ParseOperand(Parsed (ExpressionParser::*parse)()) {
  MORTISE_ASSIGN_OR_RETURN(Term term, (this->*parse)());
  MORTISE_RETURN_IF_ERROR(Require(term, Term::Kind::kNumber));
  return term;
}

ExpressionParser::Parsed ExpressionParser::ParseSum() {
  MORTISE_ASSIGN_OR_RETURN(Term sum, ParseProduct());
  while (true) {
    const bool is_plus = Take('+');
    if (!is_plus && !Take('-')) return sum;
    MORTISE_RETURN_IF_ERROR(Require(sum, Term::Kind::kNumber));
    MORTISE_ASSIGN_OR_RETURN(const Term term, ParseOperand(&ExpressionParser::ParseProduct));
    Emit(is_plus ? Operation::kAdd : Operation::kSubtract);
    sum.dimension = CommonDimension(sum.dimension, term.dimension);
  }
}

ExpressionParser::Parsed ExpressionParser::ParseProduct() {
  MORTISE_ASSIGN_OR_RETURN(Term product, ParseUnary());
  while (true) {
    const bool is_times = Take('*');
    if (!is_times && !Take('/')) return product;
    MORTISE_RETURN_IF_ERROR(Require(product, Term::Kind::kNumber));
    MORTISE_ASSIGN_OR_RETURN(const Term factor, ParseOperand(&ExpressionParser::ParseUnary));
    Emit(is_times ? Operation::kMultiply : Operation::kDivide);
    product.dimension = Product(product.dimension, factor.dimension, is_times ? 1 : -1);
  }
}

ExpressionParser::Parsed ExpressionParser::ParseUnary() {
  const DepthScope scope(depth_);
  if (depth_ > Expression::kMaxDepth) {
    return Fail(absl::StrCat("at most ", Expression::kMaxDepth, " levels of nesting"));
  }
  if (Take('-')) {
    MORTISE_ASSIGN_OR_RETURN(Term term, ParseOperand(&ExpressionParser::ParseUnary));
    Emit(Operation::kNegate);
    return term;
  }
  if (Take('+')) return ParseOperand(&ExpressionParser::ParseUnary);
  return ParsePower();
}

ExpressionParser::Parsed ExpressionParser::ParsePower() {
  MORTISE_ASSIGN_OR_RETURN(Term base, ParsePrimary());
  if (!Take('^')) return base;
  MORTISE_RETURN_IF_ERROR(Require(base, Term::Kind::kNumber));
  MORTISE_RETURN_IF_ERROR(ParseOperand(&ExpressionParser::ParseUnary).status());
  Emit(Operation::kPower);
  base.dimension.reset();
  return base;
}

ExpressionParser::Parsed ExpressionParser::ParsePrimary() {
  const char next = Peek();
  if (IsDigit(next) || next == '.') return ParseNumber();
  if (IsNameStart(next)) return ParseName();
  if (next == '\'') return ParseQuoted();
  if (Take('(')) {
    MORTISE_ASSIGN_OR_RETURN(Term inner, ParseEither());
    if (!Take(')')) return Fail("')'");
    return inner;
  }
  return Fail("a number, a name or '('");
}

ExpressionParser::Parsed ExpressionParser::ParseNumber() {
  const std::size_t column = position_;
  const std::optional<DecimalPrefix> number = DecimalNumberPrefix(text_.substr(position_));
  if (!number) return Fail("a finite number");
  position_ += number->length;
  Emit(Operation::kConstant, 0, number->value);
  return Term{.column = column};
}

absl::StatusOr<std::string_view> ExpressionParser::TakeQuoted() {
  const std::size_t begin = position_ + 1;
  const std::size_t end = text_.find('\'', begin);
  if (end == std::string_view::npos) return FailAt(position_, "the quotation has no end");
  position_ = end + 1;
  return text_.substr(begin, end - begin);
}

ExpressionParser::Parsed ExpressionParser::ParseQuoted() {
  const std::size_t column = position_;
  MORTISE_ASSIGN_OR_RETURN(const std::string_view quoted, TakeQuoted());
  return Term{.kind = Term::Kind::kQuoted,
              .column = column,
              .quoted = quoted,
              .instruction = Emit(Operation::kConstant)};
}

ExpressionParser::Parsed ExpressionParser::ParseName() {
  const std::size_t begin = position_;
  while (position_ < text_.size() && (IsNameStart(text_[position_]) || IsDigit(text_[position_]))) {
    ++position_;
  }
  const std::string_view name = text_.substr(begin, position_ - begin);
  if (const int found = FindName(name); found >= 0) {
    const ExpressionName& parameter = names_[static_cast<std::size_t>(found)];
    if (parameter.ground != nullptr) {
      return Term{.kind = Term::Kind::kGround, .column = begin, .choice = found};
    }
    Emit(Operation::kParameter, NumberOf(found));
    return Term{.kind = parameter.choices.empty() ? Term::Kind::kNumber : Term::Kind::kChoice,
                .column = begin,
                .dimension = parameter.dimension,
                .choice = found};
  }
  if (Take('(')) return name == "if" ? ParseIf(begin) : ParseCall(name, begin);
  if (name == "pi") {
    Emit(Operation::kConstant, 0, std::numbers::pi);
    return Term{.column = begin};
  }
  const std::string unknown(name);
  return FailAt(begin, absl::StrCat("there is no parameter '", unknown, "'",
                                    NamesOffered(unknown, names_, &ExpressionName::name)));
}

// ---- The program --------------------------------------------------------------------------------

std::size_t ExpressionParser::Emit(Operation operation, int parameter, double constant) {
  result_.program_.push_back({operation, parameter, constant});
  switch (operation) {
    case Operation::kConstant:
    case Operation::kParameter:
      ++stack_;
      break;
    case Operation::kNegate:
    case Operation::kAbsolute:
    case Operation::kSquareRoot:
    case Operation::kSine:
    case Operation::kCosine:
    case Operation::kTangent:
    case Operation::kFloor:
    case Operation::kCeiling:
    case Operation::kNot:
    case Operation::kJump:
      break;
    case Operation::kGroundLowest:
    case Operation::kGroundHighest:
      stack_ -= 3;
      break;
    default:
      --stack_;
      break;
  }
  result_.stack_size_ = std::max(result_.stack_size_, stack_);
  return result_.program_.size() - 1;
}

void ExpressionParser::Land(std::size_t jump) {
  result_.program_[jump].parameter = static_cast<int>(result_.program_.size());
}

bool ExpressionParser::Take(char c) {
  if (Peek() != c || position_ >= text_.size()) return false;
  ++position_;
  return true;
}

bool ExpressionParser::TakeWord(std::string_view word) {
  Peek();
  if (!text_.substr(position_).starts_with(word)) return false;
  const std::size_t end = position_ + word.size();
  if (end < text_.size() && (IsNameStart(text_[end]) || IsDigit(text_[end]))) return false;
  position_ = end;
  return true;
}

char ExpressionParser::Peek() {
  while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\t' ||
                                      text_[position_] == '\n' || text_[position_] == '\r')) {
    ++position_;
  }
  return position_ < text_.size() ? text_[position_] : '\0';
}

int ExpressionParser::FindName(std::string_view name) const {
  const auto found =
      std::find_if(names_.begin(), names_.end(),
                   [name](const ExpressionName& entry) { return entry.name == name; });
  return found == names_.end() ? -1 : static_cast<int>(found - names_.begin());
}

int ExpressionParser::NumberOf(int name) const {
  return static_cast<int>(
      std::count_if(names_.begin(), names_.begin() + name,
                    [](const ExpressionName& entry) { return entry.ground == nullptr; }));
}

absl::Status ExpressionParser::Fail(std::string_view expected) const {
  return FailAt(position_, absl::StrCat("expected ", std::string(expected)));
}

absl::Status ExpressionParser::FailAt(std::size_t column, std::string_view message) {
  return absl::InvalidArgumentError(
      absl::StrCat("column ", column + 1, ": ", std::string(message)));
}

}  // namespace mortise::parametric
