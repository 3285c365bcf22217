// Made by python -m mien.live.studio.messages: do not edit.

/** Look at another performer: this camera's pictures (which the page sends), the sample that comes with mien, an uploaded video, or a recorded take. */
export interface Look {
  kind: "Look";
  source: "none" | "camera" | "sample" | "video" | "take";
  name: string;
}

/** Who is on stage. */
export interface Cast {
  kind: "Cast";
  characters: string[];
}

/** How the performer is followed and mapped. */
export interface Way {
  kind: "Way";
  capture: string;
  mapping: string;
  gain: number;
  mirror: boolean;
}

/** The performer holds still now: their face at rest, both eyes shut, or a face that stands for a key model or, where none is named, for what is pinned of that character. No character: all that have the key model. */
export interface Hold {
  kind: "Hold";
  task: "neutral" | "lids" | "face";
  character: string;
  pose: string;
}

/** A held face means nothing any more. */
export interface Forget {
  kind: "Forget";
  number: number;
}

/** Keep in a file what is known of the performer. */
export interface Keep {
  kind: "Keep";
  name: string;
}

/** Go on with what a file tells of the performer; no name: with somebody new. */
export interface Meet {
  kind: "Meet";
  name: string;
}

/** What one morph target of one character does to what it is told. */
export interface Adjust {
  kind: "Adjust";
  character: string;
  target: string;
  gain: number;
  muted: boolean;
  pinned: number | null;
}

/** Begin or end a recording. */
export interface Recording {
  kind: "Recording";
  on: boolean;
}

/** Move in the take that is played. */
export interface Seek {
  kind: "Seek";
  time: number;
  playing: boolean;
}

/** A character on stage: its file, its morph targets in the order of their weights, the key models it acts by, and whether it came as a VRM. */
export interface Actor {
  name: string;
  url: string;
  targets: string[];
  keys: string[];
  vrm: boolean;
}

/** A face that was held: for whom, what it stands for, and how many millimetres its furthest point is from rest. */
export interface Face {
  character: string;
  pose: string;
  far: number;
}

/** Everything the page has to show. */
export interface StageSet {
  kind: "StageSet";
  session: string;
  actors: Actor[];
  characters: string[];
  models: string[];
  captures: string[];
  mappings: string[];
  videos: string[];
  takes: string[];
  performers: string[];
  faces: Face[];
  way: Omit<Way, "kind">;
  source: "none" | "camera" | "sample" | "video" | "take";
  name: string;
  sound: string;
  recording: boolean;
}

/** What came of holding still. */
export interface Learnt {
  kind: "Learnt";
  task: "neutral" | "lids" | "face";
  pose: string;
  quality: "good" | "shaky" | "refused";
  text: string;
}

/** A line for the person in front of the page. */
export interface Note {
  kind: "Note";
  text: string;
  level: "info" | "error";
}

export type FromPage = Look | Cast | Way | Hold | Forget | Keep | Meet | Adjust | Recording | Seek;
export type ToPage = StageSet | Learnt | Note;
