#include "daemon/coupling/scheme.hpp"

#include <array>
#include <string>

#include "daemon/coupling/thesis_literal.hpp"

namespace thimble::coupling {

std::string_view to_string(Scheme scheme) noexcept {
  switch (scheme) {
    case Scheme::GhostPoint:
      return "ghost-point";
    case Scheme::ThesisLiteral:
      return "thesis-literal";
  }
  return "unknown";
}

Result<Scheme> parse_scheme(std::string_view text) {
  constexpr std::array kSchemes{Scheme::GhostPoint, Scheme::ThesisLiteral};
  for (const Scheme scheme : kSchemes) {
    if (to_string(scheme) == text) return scheme;
  }
  return fail(Errc::InvalidArgument, "unknown coupling scheme '" + std::string(text) +
                                         "'; expected ghost-point or thesis-literal");
}

std::unique_ptr<ArmCoupling> make_arm_coupling(Scheme scheme, const GhostPointSettings& settings) {
  if (scheme == Scheme::ThesisLiteral) return std::make_unique<ThesisLiteralArm>(settings.age);
  return std::make_unique<GhostPointArm>(settings);
}

}  // namespace thimble::coupling
