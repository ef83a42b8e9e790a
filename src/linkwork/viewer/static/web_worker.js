"use strict";(()=>{var r="https://linkwork.invalid/",k="/lib/python3.13/site-packages",y=`
from linkwork_page import take, tell, turn
from pyodide.ffi import can_run_sync, run_sync

from linkwork.api import example_text, loads
from linkwork.viewer.live.browser_desk import BrowserDesk


def pause():
    if can_run_sync():
        run_sync(turn())


desk = BrowserDesk(loads, example_text, tell, take, pause)
begin, work = desk.begin, desk.work
`,p=[],c=null,a=!1;self.onmessage=({data:e})=>{typeof e=="string"?(p.push(e),d()):w(e).catch(n=>self.postMessage({failed:String(n)}))};async function w({engine:e,files:n,fragment:s,kept:o}){l("Starting Python …"),self.fetch=i=>Promise.resolve(h(String(i),n));let t=await loadPyodide({indexURL:r,lockFileContents:e.lock,packageBaseUrl:r});l("Loading the solver …"),t.unpackArchive(n["site.zip"],"zip",{extractDir:k});for(let i of Object.keys(n))delete n[i];let m=()=>p.splice(0);t.registerJsModule("linkwork_page",{take:m,tell:i=>self.postMessage(i),turn:u}),await t.runPythonAsync(y),l("Solving …");let[f,g]=[t.globals.get("begin"),t.globals.get("work")];f(s,o?.name??"",o?.saved??"",o?.text??""),c="Suspending"in WebAssembly?()=>g.callPromising():()=>Promise.resolve(g()),await d()}async function d(){if(!(a||c===null)){a=!0;try{for(;await c();)await u()}catch(e){self.postMessage({failed:String(e)})}a=!1}}function u(){return new Promise(e=>{let{port1:n,port2:s}=new MessageChannel;n.onmessage=()=>{n.close(),e()},s.postMessage(null)})}function h(e,n){let s=e.slice(r.length),o=s.endsWith(".wasm")?"application/wasm":"application/octet-stream",t=e.startsWith(r)?n[s]:void 0;return t?new Response(t,{headers:{"content-type":o}}):new Response(null,{status:404})}function l(e){self.postMessage({doing:e})}})();
