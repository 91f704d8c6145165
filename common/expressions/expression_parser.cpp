// The grammar of expressions, one function a rule.
#include "common/expressions/expression_parser.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/decimal_number.h"
#include "common/base/errors.h"

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

}  // namespace

ExpressionParser::ExpressionParser(std::string_view text,
                                   const std::vector<std::string>& parameters)
    : text_(text), parameters_(parameters) {}

absl::StatusOr<Expression> ExpressionParser::Parse() {
  if (text_.size() > Expression::kMaxLength) {
    return absl::InvalidArgumentError(absl::StrCat("expression of ", text_.size(),
                                                   " characters; at most ", Expression::kMaxLength,
                                                   " are accepted"));
  }
  result_.text_ = std::string(text_);
  result_.parameter_count_ = parameters_.size();
  MORTISE_RETURN_IF_ERROR(ParseSum());
  if (Peek() != '\0' || position_ < text_.size()) return Fail("an operator or the end");
  return std::move(result_);
}

absl::Status ExpressionParser::ParseSum() {
  MORTISE_RETURN_IF_ERROR(ParseProduct());
  while (true) {
    if (Take('+')) {
      MORTISE_RETURN_IF_ERROR(ParseProduct());
      Emit(Operation::kAdd);
    } else if (Take('-')) {
      MORTISE_RETURN_IF_ERROR(ParseProduct());
      Emit(Operation::kSubtract);
    } else {
      return absl::OkStatus();
    }
  }
}

absl::Status ExpressionParser::ParseProduct() {
  MORTISE_RETURN_IF_ERROR(ParseUnary());
  while (true) {
    if (Take('*')) {
      MORTISE_RETURN_IF_ERROR(ParseUnary());
      Emit(Operation::kMultiply);
    } else if (Take('/')) {
      MORTISE_RETURN_IF_ERROR(ParseUnary());
      Emit(Operation::kDivide);
    } else {
      return absl::OkStatus();
    }
  }
}

absl::Status ExpressionParser::ParseUnary() {
  const DepthScope scope(depth_);
  if (depth_ > Expression::kMaxDepth) {
    return Fail(absl::StrCat("at most ", Expression::kMaxDepth, " levels of nesting"));
  }
  if (Take('-')) {
    MORTISE_RETURN_IF_ERROR(ParseUnary());
    Emit(Operation::kNegate);
    return absl::OkStatus();
  }
  if (Take('+')) return ParseUnary();
  return ParsePower();
}

absl::Status ExpressionParser::ParsePower() {
  MORTISE_RETURN_IF_ERROR(ParsePrimary());
  if (Take('^')) {
    MORTISE_RETURN_IF_ERROR(ParseUnary());
    Emit(Operation::kPower);
  }
  return absl::OkStatus();
}

absl::Status ExpressionParser::ParsePrimary() {
  const char next = Peek();
  if (IsDigit(next) || next == '.') return ParseNumber();
  if (IsNameStart(next)) return ParseName();
  if (Take('(')) {
    MORTISE_RETURN_IF_ERROR(ParseSum());
    return Take(')') ? absl::OkStatus() : Fail("')'");
  }
  return Fail("a number, a name or '('");
}

absl::Status ExpressionParser::ParseNumber() {
  const std::optional<DecimalPrefix> number = DecimalNumberPrefix(text_.substr(position_));
  if (!number) return Fail("a finite number");
  position_ += number->length;
  Emit(Operation::kConstant, 0, number->value);
  return absl::OkStatus();
}

absl::Status ExpressionParser::ParseName() {
  const std::size_t begin = position_;
  while (position_ < text_.size() && (IsNameStart(text_[position_]) || IsDigit(text_[position_]))) {
    ++position_;
  }
  const std::string_view name = text_.substr(begin, position_ - begin);
  const auto found = std::find(parameters_.begin(), parameters_.end(), name);
  if (found != parameters_.end()) {
    Emit(Operation::kParameter, static_cast<int>(found - parameters_.begin()));
    return absl::OkStatus();
  }
  if (Take('(')) return ParseCall(name, begin);
  if (name == "pi") {
    Emit(Operation::kConstant, 0, std::numbers::pi);
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrCat("column ", begin + 1, ": there is no parameter '", std::string(name), "'"));
}

absl::Status ExpressionParser::ParseCall(std::string_view function, std::size_t column) {
  struct Function {
    std::string_view name;
    Operation operation;
    bool takes_many;
  };
  static constexpr Function kFunctions[] = {
      {"sqrt", Operation::kSquareRoot, false}, {"sin", Operation::kSine, false},
      {"cos", Operation::kCosine, false},      {"tan", Operation::kTangent, false},
      {"floor", Operation::kFloor, false},     {"ceil", Operation::kCeiling, false},
      {"abs", Operation::kAbsolute, false},    {"min", Operation::kMinimum, true},
      {"max", Operation::kMaximum, true},
  };
  const auto* found =
      std::find_if(std::begin(kFunctions), std::end(kFunctions),
                   [function](const Function& entry) { return entry.name == function; });
  if (found == std::end(kFunctions)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "column ", column + 1, ": there is no function '", std::string(function), "'"));
  }
  MORTISE_RETURN_IF_ERROR(ParseSum());
  int arguments = 1;
  while (found->takes_many && Take(',')) {
    MORTISE_RETURN_IF_ERROR(ParseSum());
    Emit(found->operation);
    ++arguments;
  }
  if (found->takes_many && arguments < 2) return Fail("','");
  if (!found->takes_many) Emit(found->operation);
  return Take(')') ? absl::OkStatus() : Fail("')'");
}

void ExpressionParser::Emit(Operation operation, int parameter, double constant) {
  result_.program_.push_back({operation, parameter, constant});
  switch (operation) {
    case Operation::kConstant:
    case Operation::kParameter:
      ++stack_;
      break;
    case Operation::kAdd:
    case Operation::kSubtract:
    case Operation::kMultiply:
    case Operation::kDivide:
    case Operation::kPower:
    case Operation::kMinimum:
    case Operation::kMaximum:
      --stack_;
      break;
    default:
      break;
  }
  result_.stack_size_ = std::max(result_.stack_size_, stack_);
}

bool ExpressionParser::Take(char c) {
  if (Peek() != c || position_ >= text_.size()) return false;
  ++position_;
  return true;
}

char ExpressionParser::Peek() {
  while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\t' ||
                                      text_[position_] == '\n' || text_[position_] == '\r')) {
    ++position_;
  }
  return position_ < text_.size() ? text_[position_] : '\0';
}

absl::Status ExpressionParser::Fail(std::string_view expected) const {
  return absl::InvalidArgumentError(
      absl::StrCat("column ", position_ + 1, ": expected ", std::string(expected)));
}

}  // namespace mortise::parametric
