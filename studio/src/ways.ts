// What the ways of following and mapping are, for who points at them.

export const CAPTURES: Record<string, string> = {
  landmarks: "Landmark networks, and a face fitted to what they see: quick and steady",
  snakes: "Curves that cling to brows, lids and lips; no learned weights",
  tracker: "The skin's look at rest found again in every picture: steadiest head, three times the work",
};

export const MAPPINGS: Record<string, string> = {
  cardinal: "Each expression exactly as the character's own examples show it, neighbours held together",
  bounded: "As cardinal, with nothing held together",
  fap: "By MPEG-4's animation parameters",
  genetic: "By a population of blends that evolves",
  wires: "Feature curve by feature curve",
};
