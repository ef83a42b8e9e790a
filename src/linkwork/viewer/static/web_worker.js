"use strict";(()=>{function*h(n){let e=new DataView(n),i=n.byteLength-22,t=e.getUint32(i+16,!0);for(let s=e.getUint16(i+10,!0);s>0;s-=1){let[a,l]=[e.getUint32(t+24,!0),e.getUint16(t+28,!0)],o=e.getUint32(t+42,!0),p=o+30+e.getUint16(o+26,!0)+e.getUint16(o+28,!0);yield{name:new TextDecoder().decode(new Uint8Array(n,t+46,l)),content:new Uint8Array(n,p,a)},t+=46+l+e.getUint16(t+30,!0)+e.getUint16(t+32,!0)}}var d="https://linkwork.invalid/",b="/lib/python3.13/site-packages",E=["python_stdlib.zip","site.zip"],y="/tmp/site.zip",g="/tmp/prepared.zip",P=3e3,U=`
from linkwork_page import take, tell, turn
from pyodide.ffi import can_run_sync, run_sync

from linkwork.api import example_text, loads
from linkwork.viewer.live.browser_desk import BrowserDesk


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, pause)
begin, work = desk.begin, desk.work
`,_=`
from pathlib import Path

from linkwork.viewer.live.bytecode import with_bytecode

STDLIB = Path("/lib/python313.zip")

steps = {
    "python_stdlib.zip": with_bytecode(STDLIB, STDLIB, Path("${g}")),
    "site.zip": with_bytecode(Path("${y}"), Path("${b}"), Path("${g}")),
}


def prepare(name):
    return next(steps[name], 0) is None
`,S=[],f=null,c=!1;self.onmessage=({data:n})=>{typeof n=="string"?(S.push(n),v()):x(n).catch(e=>self.postMessage({failed:String(e)}))};async function x({engine:n,files:e,fragment:i,kept:t,prepare:s,machine:a}){u("Starting Python …",.35);let{fetch:l}=self;self.fetch=async r=>a&&String(r).endsWith(".wasm")?l(a):R(String(r),e);let o=await loadPyodide({indexURL:d,lockFileContents:n.lock,packageBaseUrl:d});u("Loading the solver …",.7);for(let{name:r,content:A}of h(e["site.zip"])){let m=`${b}/${r}`;o.FS.mkdirTree(m.slice(0,m.lastIndexOf("/"))),o.FS.writeFile(m,A,{canOwn:!0})}s&&o.FS.writeFile(y,new Uint8Array(e["site.zip"]),{canOwn:!0});for(let r of Object.keys(e))delete e[r];let p=()=>S.splice(0);o.registerJsModule("linkwork_page",{take:p,tell:r=>self.postMessage(r),turn:F}),await o.runPythonAsync(U),u("Solving …",.9);let[w,k]=[o.globals.get("begin"),o.globals.get("work")];w(i,t?.name??"",t?.saved??"",t?.text??""),f="Suspending"in WebAssembly?()=>k.callPromising():()=>Promise.resolve(k()),await v(),s&&await D(o)}async function D(n){await new Promise(s=>setTimeout(s,P)),await n.runPythonAsync(_);let e=n.globals.get("prepare"),i=[...E],t=()=>{let[s]=i;if(s===void 0)n.FS.unlink(y);else if(c)setTimeout(t,P);else{if(!e(s)){let a=n.FS.readFile(g).buffer;n.FS.unlink(g),self.postMessage({prepared:{[s]:a}},[a]),i.shift()}setTimeout(t)}};t()}async function v(){if(!(c||f===null)){c=!0;try{for(;await f();)await F()}catch(n){self.postMessage({failed:String(n)})}c=!1}}function F(){return new Promise(n=>{let{port1:e,port2:i}=new MessageChannel;e.onmessage=()=>{e.close(),n()},i.postMessage(null)})}function R(n,e){let i=n.slice(d.length),t=i.endsWith(".wasm")?"application/wasm":"application/octet-stream",s=n.startsWith(d)?e[i]:void 0;return s?new Response(s,{headers:{"content-type":t}}):new Response(null,{status:404})}function u(n,e){self.postMessage({doing:n,done:e})}})();
