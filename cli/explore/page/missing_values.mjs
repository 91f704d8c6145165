// Why a map has no values in parts of its space, for people.

// What came about there, as the end of "where …".
export function causesOf(map) {
  const causes = [];
  if (map.failures.length > 0 || map.unmapped === 0) causes.push("evaluations failed");
  if (map.unmapped > 0) causes.push("shapes could not be brought into one mesh");
  return causes.join(" or ");
}

// What is known of why: {count, message} each.
export function reasonsOf(map) {
  if (map.unmapped === 0) return map.failures;
  const nameless = [{ count: map.unmapped, message: "in none of the meshes around" }];
  return [...map.failures, ...(map.unmappedFailures.length > 0 ? map.unmappedFailures : nameless)];
}

// What is told of a design that has no values.
export function whyNoValues(map) {
  const [reason] = reasonsOf(map);
  return `Around this design ${causesOf(map)}${reason ? `, as: ${reason.message}` : "."}`;
}
