import { describe, expect, it } from "vitest";
import { lasting, Player, REST } from "../src/player";

const playing = (count: number, closed: boolean): Player => {
  const player = new Player(count, closed);
  player.play(true);
  return player;
};

describe("the player", () => {
  it("passes a closed way around and around", () => {
    const player = playing(360, true);
    player.advance(1.25 * lasting(360));
    expect(player.at).toBe(90);
  });

  it("passes an open way to and fro", () => {
    const player = playing(100, false);
    player.advance(0.99 * lasting(100));
    player.advance(0.02 * lasting(100));
    player.advance(0.5 * lasting(100));
    expect(player.at).toBe(49);
  });

  it("keeps to its ends on an open way", () => {
    const player = new Player(10, false);
    player.go(99);
    expect(player.at).toBe(9);
    player.go(-3);
    expect(player.at).toBe(0);
  });

  it("stops when it is stepped", () => {
    const player = playing(360, true);
    player.step(-1);
    expect([player.at, player.playing]).toEqual([359, false]);
  });

  it("tells only when the row changes", () => {
    const player = playing(360, true);
    let told = 0;
    player.onChange(() => (told += 1));
    player.advance(0.1 * (lasting(360) / 360));
    expect(told).toBe(0);
    player.advance(lasting(360) / 360);
    expect(told).toBe(1);
  });

  it("does not play a single row", () => {
    expect(playing(1, true).playing).toBe(false);
  });

  describe("of a motion in time", () => {
    // an event at 0.25 s has a row of its own, and one at 1 s a second one
    const times = Float64Array.of(0, 0.25, 0.5, 1, 1, 2);
    const inTime = (): Player => {
      const player = new Player(1, true);
      player.restart(times.length, false, 0, times);
      player.play(true);
      return player;
    };

    it("shows the last row that has come", () => {
      const player = inTime();
      const shown = [0.24, 0.02, 0.5, 0.25, 0.98].map((passed) => {
        player.advance(passed);
        return player.at;
      });
      expect(shown).toEqual([0, 1, 2, 4, 4]);
    });

    it("plays ten times as fast", () => {
      const player = inTime();
      player.speed = 10;
      player.advance(0.1);
      expect(player.at).toBe(4);
    });

    it("rests at its end, then starts again", () => {
      const player = inTime();
      player.advance(2 + 0.9 * REST);
      expect(player.at).toBe(5);
      player.advance(0.2 * REST);
      expect(player.at).toBe(0);
    });

    it("steps through rows of the same time", () => {
      const player = inTime();
      player.step(3);
      player.step(1);
      expect(player.at).toBe(4);
      player.step(-1);
      expect(player.at).toBe(3);
    });
  });
});
