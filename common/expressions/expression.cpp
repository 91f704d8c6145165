// Evaluates expressions: a stack machine that carries a gradient along with every value.
#include "common/expressions/expression.h"

#include <algorithm>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/expressions/expression_parser.h"
#include "common/terrain/height_field.h"

namespace mortise::parametric {
namespace {

// The operand stack: one value and one gradient column a level.
struct Stack {
  Eigen::VectorXd values;
  Eigen::MatrixXd gradients;
  Eigen::Index top = 0;  // number of operands

  Stack(Eigen::Index levels, Eigen::Index rows) : values(levels), gradients(rows, levels) {}

  void Push(double value) {
    values(top) = value;
    gradients.col(top).setZero();
    ++top;
  }
  double& Value(int below) { return values(top - 1 - below); }
  auto Gradient(int below) { return gradients.col(top - 1 - below); }
  auto Upper(int count) const { return values.segment(top - count, count); }
  void Pop() { --top; }
};

// Multiplies a gradient by the outer derivative. 0 times an infinite derivative counts as 0: an
// operand that does not depend on the parameters has no say.
template <typename Column>
void Scale(Column&& gradient, double derivative) {
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    if (gradient(i) != 0) gradient(i) *= derivative;
  }
}

void ApplyPower(Stack& stack) {
  const double base = stack.Value(1);
  const double exponent = stack.Value(0);
  const double power = std::pow(base, exponent);
  Scale(stack.Gradient(1), exponent == 0 ? 0.0 : exponent * std::pow(base, exponent - 1));
  Scale(stack.Gradient(0), power * std::log(base));
  stack.Gradient(1) += stack.Gradient(0);
  stack.Value(1) = power;
  stack.Pop();
}

void ApplyQuotient(Stack& stack) {
  const double denominator = stack.Value(0);
  const double quotient = stack.Value(1) / denominator;
  stack.Gradient(1) = (stack.Gradient(1) - quotient * stack.Gradient(0)) / denominator;
  stack.Value(1) = quotient;
  stack.Pop();
}

// Keeps the operand that `keep_upper` says.
void Choose(Stack& stack, bool keep_upper) {
  if (keep_upper) {
    stack.Value(1) = stack.Value(0);
    stack.Gradient(1) = stack.Gradient(0);
  }
  stack.Pop();
}

// Leaves a condition, which has no derivative.
void Compare(Stack& stack, bool holds) {
  stack.Pop();
  stack.Value(0) = holds ? 1 : 0;
  stack.Gradient(0).setZero();
}

void ApplyFunction(Stack& stack, double value, double derivative) {
  stack.Value(0) = value;
  Scale(stack.Gradient(0), derivative);
}

// Puts a value in place of the operands that it has derivatives by.
void ApplyGround(Stack& stack, const Dual& found) {
  const auto operands = static_cast<int>(found.gradient.size());
  for (int i = 0; i < operands; ++i) Scale(stack.Gradient(i), found.gradient(operands - 1 - i));
  for (int i = 1; i < operands; ++i) {
    stack.Gradient(1) += stack.Gradient(0);
    stack.Pop();
  }
  stack.Value(0) = found.value;
}

}  // namespace

absl::StatusOr<Expression> Expression::Parse(std::string_view text,
                                             const std::vector<ExpressionName>& parameters) {
  return ExpressionParser(text, parameters).Parse(false);
}

absl::StatusOr<Expression> Expression::Parse(std::string_view text,
                                             const std::vector<std::string>& parameters) {
  std::vector<ExpressionName> names;
  for (const std::string& name : parameters) names.push_back({name});
  return ExpressionParser(text, names).Parse(false);
}

absl::StatusOr<Expression> Expression::ParseCondition(
    std::string_view text, const std::vector<ExpressionName>& parameters) {
  return ExpressionParser(text, parameters).Parse(true);
}

absl::StatusOr<double> Expression::Value(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  MORTISE_ASSIGN_OR_RETURN(const Dual result, Run(q, 0));
  return result.value;
}

absl::StatusOr<Dual> Expression::ValueAndGradient(
    const Eigen::Ref<const Eigen::VectorXd>& q) const {
  return Run(q, static_cast<Eigen::Index>(parameter_count_));
}

absl::StatusOr<bool> Expression::Holds(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  MORTISE_ASSIGN_OR_RETURN(const Dual result, Run(q, 0));
  return result.value != 0;
}

bool Expression::Uses(int parameter) const {
  return std::any_of(program_.begin(), program_.end(), [parameter](const Instruction& instruction) {
    return instruction.operation == Operation::kParameter && instruction.parameter == parameter;
  });
}

absl::StatusOr<Dual> Expression::AskGround(
    const Instruction& instruction, const Eigen::Ref<const Eigen::VectorXd>& operands) const {
  const NamedGround& ground = grounds_[static_cast<std::size_t>(instruction.parameter)];
  const auto answer = [&](const auto& found) -> absl::StatusOr<Dual> {
    if (found.ok()) return Dual{found->value, found->gradient};
    return absl::InvalidArgumentError(
        absl::StrCat("'", text_, "': ground '", ground.name, "' ", found.status().message()));
  };
  const terrain::HeightField& heights = *ground.heights;
  if (instruction.operation == Operation::kGroundHeight) {
    return answer(heights.HeightAt(operands(0), operands(1)));
  }
  if (instruction.operation == Operation::kGroundSlope) {
    return answer(heights.SlopeAt(operands(0), operands(1)));
  }
  const terrain::Rectangle rectangle = {operands(0), operands(1), operands(2), operands(3)};
  return instruction.operation == Operation::kGroundLowest
             ? answer(heights.LowestUnder(rectangle))
             : answer(heights.HighestUnder(rectangle));
}

absl::StatusOr<Dual> Expression::Run(const Eigen::Ref<const Eigen::VectorXd>& q,
                                     Eigen::Index rows) const {
  if (q.size() != static_cast<Eigen::Index>(parameter_count_)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "expression '", text_, "' has ", parameter_count_, " parameters, not ", q.size()));
  }
  Stack stack(stack_size_, rows);
  for (std::size_t next = 0; next < program_.size();) {
    const Instruction& instruction = program_[next++];
    switch (instruction.operation) {
      case Operation::kConstant:
        stack.Push(instruction.constant);
        break;
      case Operation::kParameter:
        stack.Push(q(instruction.parameter));
        if (rows > 0) stack.Gradient(0)(instruction.parameter) = 1;
        break;
      case Operation::kNegate:
        ApplyFunction(stack, -stack.Value(0), -1);
        break;
      case Operation::kAdd:
        stack.Value(1) += stack.Value(0);
        stack.Gradient(1) += stack.Gradient(0);
        stack.Pop();
        break;
      case Operation::kSubtract:
        stack.Value(1) -= stack.Value(0);
        stack.Gradient(1) -= stack.Gradient(0);
        stack.Pop();
        break;
      case Operation::kMultiply:
        stack.Gradient(1) = stack.Gradient(1) * stack.Value(0) + stack.Gradient(0) * stack.Value(1);
        stack.Value(1) *= stack.Value(0);
        stack.Pop();
        break;
      case Operation::kDivide:
        if (stack.Value(0) == 0) {
          return absl::InvalidArgumentError(absl::StrCat("'", text_, "' divides by zero"));
        }
        ApplyQuotient(stack);
        break;
      case Operation::kPower:
        ApplyPower(stack);
        break;
      case Operation::kMinimum:
        Choose(stack, stack.Value(0) < stack.Value(1));
        break;
      case Operation::kMaximum:
        Choose(stack, stack.Value(0) > stack.Value(1));
        break;
      case Operation::kAbsolute:
        ApplyFunction(stack, std::abs(stack.Value(0)), stack.Value(0) < 0 ? -1 : 1);
        break;
      case Operation::kSquareRoot: {
        const double root = std::sqrt(stack.Value(0));
        ApplyFunction(stack, root, 0.5 / root);
        break;
      }
      case Operation::kSine:
        ApplyFunction(stack, std::sin(stack.Value(0)), std::cos(stack.Value(0)));
        break;
      case Operation::kCosine:
        ApplyFunction(stack, std::cos(stack.Value(0)), -std::sin(stack.Value(0)));
        break;
      case Operation::kTangent: {
        const double tangent = std::tan(stack.Value(0));
        ApplyFunction(stack, tangent, 1 + tangent * tangent);
        break;
      }
      case Operation::kFloor:
        ApplyFunction(stack, std::floor(stack.Value(0)), 0);
        break;
      case Operation::kCeiling:
        ApplyFunction(stack, std::ceil(stack.Value(0)), 0);
        break;
      case Operation::kEqual:
        Compare(stack, stack.Value(1) == stack.Value(0));
        break;
      case Operation::kNotEqual:
        Compare(stack, stack.Value(1) != stack.Value(0));
        break;
      case Operation::kLess:
        Compare(stack, stack.Value(1) < stack.Value(0));
        break;
      case Operation::kLessOrEqual:
        Compare(stack, stack.Value(1) <= stack.Value(0));
        break;
      case Operation::kGreater:
        Compare(stack, stack.Value(1) > stack.Value(0));
        break;
      case Operation::kGreaterOrEqual:
        Compare(stack, stack.Value(1) >= stack.Value(0));
        break;
      case Operation::kNot:
        stack.Value(0) = stack.Value(0) == 0 ? 1 : 0;
        break;
      case Operation::kGroundHeight:
      case Operation::kGroundSlope: {
        MORTISE_ASSIGN_OR_RETURN(const Dual found, AskGround(instruction, stack.Upper(2)));
        ApplyGround(stack, found);
        break;
      }
      case Operation::kGroundLowest:
      case Operation::kGroundHighest: {
        MORTISE_ASSIGN_OR_RETURN(const Dual found, AskGround(instruction, stack.Upper(4)));
        ApplyGround(stack, found);
        break;
      }
      case Operation::kJump:
        next = static_cast<std::size_t>(instruction.parameter);
        continue;
      case Operation::kJumpUnless: {
        const bool holds = stack.Value(0) != 0;
        stack.Pop();
        if (!holds) next = static_cast<std::size_t>(instruction.parameter);
        continue;
      }
      case Operation::kJumpIfNot:
      case Operation::kJumpIf:
        if ((stack.Value(0) != 0) == (instruction.operation == Operation::kJumpIf)) {
          next = static_cast<std::size_t>(instruction.parameter);
        } else {
          stack.Pop();
        }
        continue;
    }
    if (!std::isfinite(stack.Value(0))) {
      return absl::InvalidArgumentError(
          absl::StrCat("'", text_, "' has no finite value at these parameters"));
    }
    if (!stack.Gradient(0).allFinite()) {
      return absl::InvalidArgumentError(
          absl::StrCat("'", text_, "' has no finite derivative at these parameters"));
    }
  }
  return Dual{stack.Value(0), stack.Gradient(0)};
}

}  // namespace mortise::parametric
