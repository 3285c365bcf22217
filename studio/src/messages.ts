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

/** The performer's next second is their rest. */
export interface Learn {
  kind: "Learn";
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

/** A character on stage: its file, and its morph targets in the order of their weights. */
export interface Actor {
  name: string;
  url: string;
  targets: string[];
}

/** Everything the page has to show. */
export interface StageSet {
  kind: "StageSet";
  actors: Actor[];
  characters: string[];
  captures: string[];
  mappings: string[];
  videos: string[];
  takes: string[];
  way: Omit<Way, "kind">;
  source: "none" | "camera" | "sample" | "video" | "take";
  recording: boolean;
}

/** A line for the person in front of the page. */
export interface Note {
  kind: "Note";
  text: string;
  level: "info" | "error";
}

export type FromPage = Look | Cast | Way | Learn | Adjust | Recording | Seek;
export type ToPage = StageSet | Note;
