"use strict";(()=>{function*w(n){let e=new DataView(n),s=n.byteLength-22,t=e.getUint32(s+16,!0);for(let r=e.getUint16(s+10,!0);r>0;r-=1){let[o,l]=[e.getUint32(t+24,!0),e.getUint16(t+28,!0)],a=e.getUint32(t+42,!0),c=a+30+e.getUint16(a+26,!0)+e.getUint16(a+28,!0);yield{name:new TextDecoder().decode(new Uint8Array(n,t+46,l)),content:new Uint8Array(n,c,o)},t+=46+l+e.getUint16(t+30,!0)+e.getUint16(t+32,!0)}}var d="https://linkwork.invalid/",h="/lib/python3.13/site-packages",F=["python_stdlib.zip","site.zip"],y="/tmp/site.zip",g="/tmp/prepared.zip",k=3e3,A=`
from pathlib import Path

from linkwork_page import take, tell, turn
from pyodide.ffi import can_run_sync, run_sync

from linkwork.api import example_text, loads
from linkwork.viewer.live.browser_desk import BrowserDesk
from linkwork.viewer.live.bytecode import with_bytecode

STDLIB = Path("/lib/python313.zip")


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, pause)
begin, work = desk.begin, desk.work
steps = {
    "python_stdlib.zip": with_bytecode(STDLIB, STDLIB, Path("${g}")),
    "site.zip": with_bytecode(Path("${y}"), Path("${h}"), Path("${g}")),
}


def prepare(name):
    return next(steps[name], 0) is None
`,P=[],f=null,p=!1;self.onmessage=({data:n})=>{typeof n=="string"?(P.push(n),b()):U(n).catch(e=>self.postMessage({failed:String(e)}))};async function U({engine:n,files:e,fragment:s,kept:t,prepare:r}){m("Starting Python …",.35),self.fetch=i=>Promise.resolve(_(String(i),e));let o=await loadPyodide({indexURL:d,lockFileContents:n.lock,packageBaseUrl:d});m("Loading the solver …",.7);for(let{name:i,content:S}of w(e["site.zip"])){let u=`${h}/${i}`;o.FS.mkdirTree(u.slice(0,u.lastIndexOf("/"))),o.FS.writeFile(u,S,{canOwn:!0})}r&&o.FS.writeFile(y,new Uint8Array(e["site.zip"]),{canOwn:!0});for(let i of Object.keys(e))delete e[i];let l=()=>P.splice(0);o.registerJsModule("linkwork_page",{take:l,tell:i=>self.postMessage(i),turn:v}),await o.runPythonAsync(A),m("Solving …",.9);let[a,c]=[o.globals.get("begin"),o.globals.get("work")];a(s,t?.name??"",t?.saved??"",t?.text??""),f="Suspending"in WebAssembly?()=>c.callPromising():()=>Promise.resolve(c()),await b(),r&&E(o)}function E(n){let e=n.globals.get("prepare"),s=[...F],t=()=>{let[r]=s;if(r===void 0)n.FS.unlink(y);else if(p)setTimeout(t,k);else{if(!e(r)){let o=n.FS.readFile(g).buffer;n.FS.unlink(g),self.postMessage({prepared:{[r]:o}},[o]),s.shift()}setTimeout(t)}};setTimeout(t,k)}async function b(){if(!(p||f===null)){p=!0;try{for(;await f();)await v()}catch(n){self.postMessage({failed:String(n)})}p=!1}}function v(){return new Promise(n=>{let{port1:e,port2:s}=new MessageChannel;e.onmessage=()=>{e.close(),n()},s.postMessage(null)})}function _(n,e){let s=n.slice(d.length),t=s.endsWith(".wasm")?"application/wasm":"application/octet-stream",r=n.startsWith(d)?e[s]:void 0;return r?new Response(r,{headers:{"content-type":t}}):new Response(null,{status:404})}function m(n,e){self.postMessage({doing:n,done:e})}})();
