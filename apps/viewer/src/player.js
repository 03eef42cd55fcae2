// Which frame is shown: one number that the slider, the plots, the keyboard and the play button share.
export class Player {
  constructor(count) {
    this.count = count;
    this.index = -1;
    this.listeners = [];
    this.timer = null;
  }

  onChange(act) { this.listeners.push(act); }

  show(index) {
    const bounded = Math.max(0, Math.min(this.count - 1, Math.round(index)));
    if (bounded === this.index) return;
    this.index = bounded;
    for (const act of this.listeners) act(bounded);
  }

  get playing() { return this.timer !== null; }

  play(framesPerSecond = 10) {
    if (this.index >= this.count - 1) this.show(0);
    this.timer = setInterval(() => {
      if (this.index >= this.count - 1) this.pause();
      else this.show(this.index + 1);
    }, 1000 / framesPerSecond);
    this.playChanged?.();
  }

  pause() {
    clearInterval(this.timer);
    this.timer = null;
    this.playChanged?.();
  }

  toggle() { this.playing ? this.pause() : this.play(); }
}

// Keys that work wherever no other control takes them.
export function listenToKeys(player) {
  const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 };
  document.addEventListener('keydown', (event) => {
    const busy = event.target.closest?.('input, button, select, textarea, a');
    if (busy || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === ' ') player.toggle();
    else if (event.key === 'Home') player.show(0);
    else if (event.key === 'End') player.show(player.count - 1);
    // Up, down and the page keys scroll the page unless the slider has the focus.
    else if (event.key === 'ArrowRight' || event.key === 'ArrowLeft') player.show(player.index + steps[event.key]);
    else return;
    event.preventDefault();
  });
}
