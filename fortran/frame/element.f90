!> Macro-elements in the plane of a wall: piers and spandrels between rigid nodes.
!>
!> A pier is in equilibrium: its sections at Gauss-Lobatto points carry N and moments that are linear along it, and
!> their strains, with the shear, make up its deformation. A beam is elastic between plastic hinges.
module frame_element
   use common_kinds, only : wp
   use common_lists, only : frame_shear_none, frame_state_sound, frame_state_cracked, frame_state_flexure, &
      frame_state_shear, frame_state_failed_flexure, frame_state_failed_shear
   use common_status, only : status_ok, status_singular, status_too_many_steps
   use frame_laws, only : masonry_section, crushing, section_forces, crushed_further, shear_law, shear_resistance, &
      back_stress, damage_at
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: macro_element, element_state, element_forces, element_committed, element_failed, most_sections

   integer, parameter :: most_sections = 5

   type :: macro_element
      logical :: pier = .true.               !! else a beam between plastic hinges
      logical :: upright = .true.            !! its axis is vertical, else along the wall
      integer(c_int) :: freedom(6) = 0       !! u, w, rotation of both nodes; 0 is held
      real(wp) :: offset(2, 2) = 0.0_wp      !! (2, ends) from node to end: along the wall, upward [m]
      real(wp) :: length = 1.0_wp            !! of the deformable part [m]
      type(masonry_section) :: section
      type(shear_law) :: shear
      real(wp) :: shear_stiffness = 0.0_wp   !! force by relative displacement of the ends [N/m]
      integer :: sections = most_sections    !! 3 or 5
      real(wp) :: drift(2) = huge(1.0_wp)    !! limits: in flexure, in shear
      real(wp) :: kept = 0.0_wp              !! beam: share of its strength that is left beyond a limit
      logical :: second_order = .true.       !! P-Delta
      real(wp) :: own_weight = 0.0_wp        !! pier: N grows by it from the upper end to the lower one, both nodes carry half of it [N]
      real(wp) :: inertia_stiffness = 0.0_wp !! beam: E I [N m^2]
      real(wp) :: axial_stiffness = 0.0_wp   !! beam: E A [N]
      real(wp) :: moment = huge(1.0_wp)      !! beam: strength of the hinges [N m]
      logical :: hinge_by_shear = .false.    !! beam: the shear strength makes the hinge's
   end type macro_element

   type :: element_state
      real(wp) :: strain(2, most_sections) = 0.0_wp
      real(wp) :: force(3) = 0.0_wp          !! N (compression), moments at both ends, counter-clockwise
      real(wp) :: deformation(3) = 0.0_wp    !! shortening [m], chord rotations of both ends
      real(wp) :: slip = 0.0_wp              !! [m]
      real(wp) :: damage = 0.0_wp
      real(wp) :: hinge(2) = 0.0_wp          !! plastic rotations of a beam
      type(crushing) :: crushed(most_sections)
      integer(c_int) :: state = frame_state_sound
      !> As it failed: N, shortening, mean of the end moments, half their difference, difference of the rotations
      real(wp) :: failed(5) = 0.0_wp
      real(wp) :: left = 1.0_wp              !! share of the strength in shear that is still there
      logical :: settled = .false.           !! under its loads: N follows its own weight
   end type element_state

   real(wp), parameter :: place3(3) = [0.0_wp, 0.5_wp, 1.0_wp]
   real(wp), parameter :: weight3(3) = [1.0_wp, 4.0_wp, 1.0_wp] / 6.0_wp
   real(wp), parameter :: inner = 0.65465367070797714380_wp   !! sqrt(3/7)
   real(wp), parameter :: place5(5) = [0.0_wp, 0.5_wp * (1.0_wp - inner), 0.5_wp, 0.5_wp * (1.0_wp + inner), 1.0_wp]
   real(wp), parameter :: weight5(5) = [9.0_wp, 49.0_wp, 64.0_wp, 49.0_wp, 9.0_wp] / 180.0_wp
   !> Flexural strength counts as reached at this share of N (L - N/(f t))/2, which is an asymptote
   real(wp), parameter :: at_strength = 0.95_wp
   integer, parameter :: most_iterations = 60

contains

   !> Forces of an element on its freedoms, and their tangent, for displacements of these
   pure subroutine element_forces(element, past, d, lagged, state, force, tangent, status)
      type(macro_element), intent(in) :: element
      type(element_state), intent(in) :: past
      real(wp), intent(in) :: d(6)                 !! u, w, rotation of both nodes
      logical, intent(in) :: lagged                !! shear strength by the forces of `past`
      type(element_state), intent(inout) :: state  !! first guess of strains in; what these displacements make of it out
      real(wp), intent(out) :: force(6)
      real(wp), intent(out) :: tangent(6, 6)
      integer(c_int), intent(out) :: status
      real(wp) :: ends(6), to_ends(6, 6), local(6), v(3), b(3, 6), kb(3, 3), kept(2, 2), across, axial, turn
      integer :: e
      ! Ends of the deformable part: rigid arms, to second order of the rotation
      to_ends = 0.0_wp
      do e = 0, 1
         turn = merge(d(3 * e + 3), 0.0_wp, element%second_order)
         associate (x => element%offset(1, e + 1), z => element%offset(2, e + 1))
            ends(3 * e + 1) = d(3 * e + 1) - z * d(3 * e + 3) - 0.5_wp * x * turn**2
            ends(3 * e + 2) = d(3 * e + 2) + x * d(3 * e + 3) - 0.5_wp * z * turn**2
            ends(3 * e + 3) = d(3 * e + 3)
            to_ends(3 * e + 1, 3 * e + 1) = 1.0_wp
            to_ends(3 * e + 2, 3 * e + 2) = 1.0_wp
            to_ends(3 * e + 3, 3 * e + 3) = 1.0_wp
            to_ends(3 * e + 1, 3 * e + 3) = -z - x * turn
            to_ends(3 * e + 2, 3 * e + 3) = x - z * turn
         end associate
      end do
      ! Along the axis and across it; a beam's axis goes along the wall
      local = ends
      if (.not. element%upright) then
         local([1, 4]) = -ends([2, 5])
         local([2, 5]) = ends([1, 4])
      end if
      across = local(4) - local(1)
      axial = local(5) - local(2)
      b = 0.0_wp
      associate (h => element%length)
         v = [-axial, local(3) + across / h, local(6) + across / h]
         b(1, [2, 5]) = [1.0_wp, -1.0_wp]
         b(2:3, 1) = -1.0_wp / h
         b(2:3, 4) = 1.0_wp / h
         b(2, 3) = 1.0_wp
         b(3, 6) = 1.0_wp
         if (element%second_order) then
            v(1) = v(1) - 0.5_wp * across**2 / h
            b(1, [1, 4]) = [across, -across] / h
         end if
      end associate
      if (element%pier .and. state%state >= frame_state_failed_flexure) then
         call failed_forces(element, v, state, kb)
         status = status_ok
      else if (element%pier) then
         call pier_forces(element, past, v, lagged, state, kb, status)
      else
         call beam_forces(element, past, v, state, kb)
         status = status_ok
      end if
      state%deformation = v
      ! What every element keeps of its elastic stiffness, so that no storey is without any
      kept = residual_stiffness(element)
      kb(2:3, 2:3) = kb(2:3, 2:3) + kept
      force = matmul(state%force + [0.0_wp, matmul(kept, v(2:3))], b)
      tangent = matmul(transpose(b), matmul(kb, b))
      if (element%second_order) then
         associate (g => state%force(1) / element%length)
            tangent([1, 4], 1) = tangent([1, 4], 1) + [-g, g]
            tangent([1, 4], 4) = tangent([1, 4], 4) + [g, -g]
         end associate
      end if
      if (.not. element%upright) then
         force([1, 2, 4, 5]) = [force(2), -force(1), force(5), -force(4)]
         tangent = turned(tangent)
      end if
      tangent = matmul(transpose(to_ends), matmul(tangent, to_ends))
      if (element%second_order) then
         do e = 0, 1
            tangent(3 * e + 3, 3 * e + 3) = tangent(3 * e + 3, 3 * e + 3) &
               - dot_product(element%offset(:, e + 1), force(3 * e + 1:3 * e + 2))
         end do
      end if
      force = matmul(force, to_ends)
   end subroutine element_forces

   !> Moments by chord rotations that an element keeps whatever has happened to it
   pure function residual_stiffness(element) result(kept)
      type(macro_element), intent(in) :: element
      real(wp) :: kept(2, 2)
      associate (section => element%section)
         kept = section%residual * section%young * section%thickness * section%length**3 / (6.0_wp * element%length) &
            * reshape([2.0_wp, 1.0_wp, 1.0_wp, 2.0_wp], [2, 2])
      end associate
   end function residual_stiffness

   !> The tangent of a beam from its own axes to those of the wall
   pure function turned(k) result(own)
      real(wp), intent(in) :: k(6, 6)
      real(wp) :: own(6, 6), turn(6, 6)
      turn = 0.0_wp   ! local = turn . wall
      turn(1, 2) = -1.0_wp
      turn(2, 1) = 1.0_wp
      turn(3, 3) = 1.0_wp
      turn(4, 5) = -1.0_wp
      turn(5, 4) = 1.0_wp
      turn(6, 6) = 1.0_wp
      own = matmul(transpose(turn), matmul(k, turn))
   end function turned

   !> Forces and tangent of a pier: Newton's method on the strains of its sections, N, the moments, and the slip.
   !>
   !> Strains are eliminated: F dq + a ds = deformation not yet reached, F the flexibility. The strains minimise
   !> a convex energy, so a step goes back until it no longer overshoots.
   pure subroutine pier_forces(element, past, v, lagged, state, stiffness, status)
      type(macro_element), intent(in) :: element
      type(element_state), intent(in) :: past
      real(wp), intent(in) :: v(3)
      logical, intent(in) :: lagged
      type(element_state), intent(inout) :: state
      real(wp), intent(out) :: stiffness(3, 3)
      integer(c_int), intent(out) :: status
      real(wp) :: place(most_sections), weight(most_sections), b(2, 3), s(2), k(2, 2), f(2, 2), gap(2)
      real(wp) :: flexible(3, 3), missing(3), a(3), gradient(3), step(2, most_sections), change(4), over
      real(wp) :: own(2, 3, most_sections), loose(2, most_sections), resistance, by(2), back, by_slip, sense
      real(wp) :: scale(3), reach, slope0, slope1, trial(2), resisted, heavy(2, most_sections)
      integer :: n, i, iteration, halving, end
      logical :: slides, done
      n = element%sections
      if (n == 3) then
         place(1:3) = place3
         weight(1:3) = weight3 * element%length
      else
         place = place5
         weight = weight5 * element%length
      end if
      a = [0.0_wp, 1.0_wp, 1.0_wp] / element%length
      heavy = 0.0_wp   ! N of a section beyond that at the middle
      if (past%settled) heavy(1, 1:n) = element%own_weight * (0.5_wp - place(1:n))
      associate (section => element%section, q => state%force)
         slides = state%slip /= past%slip
         sense = sign(1.0_wp, state%slip - past%slip)
         status = status_too_many_steps
         do iteration = 1, most_iterations
            scale(1) = 1.0e-13_wp * section%young * section%length * section%thickness &
               + 1.0e-9_wp * max(abs(q(1)), maxval(abs(q(2:3))) / section%length)
            scale(2:3) = scale(1) * section%length
            flexible = 0.0_wp
            missing = v - a * state%slip
            reach = 0.0_wp
            do i = 1, n
               b(1, :) = [1.0_wp, 0.0_wp, 0.0_wp]
               b(2, :) = [0.0_wp, 1.0_wp - place(i), -place(i)]
               call section_forces(section, state%strain(:, i), past%crushed(i), s, k)
               over = k(1, 1) * k(2, 2) - k(1, 2) * k(2, 1)
               f(1, :) = [k(2, 2), -k(1, 2)] / over
               f(2, :) = [-k(2, 1), k(1, 1)] / over
               gap = matmul(b, q) + heavy(:, i) - s
               reach = max(reach, abs(gap(1)) / scale(1), abs(gap(2)) / scale(2))
               own(:, :, i) = matmul(f, b)
               loose(:, i) = matmul(f, gap)
               flexible = flexible + weight(i) * matmul(transpose(b), own(:, :, i))
               missing = missing - weight(i) * matmul(state%strain(:, i) + loose(:, i), b)
            end do
            if (element%shear_stiffness > 0.0_wp) then
               flexible(:, 2) = flexible(:, 2) + a * a(2) / element%shear_stiffness
               flexible(:, 3) = flexible(:, 3) + a * a(3) / element%shear_stiffness
               missing = missing - a * dot_product(a, q) / element%shear_stiffness
            end if
            ! Sliding: V - B(s) = sense R(N, M)
            done = .true.
            change = 0.0_wp
            resistance = huge(1.0_wp)
            if (element%shear%kind /= frame_shear_none) then
               end = merge(2, 3, abs(q(2)) >= abs(q(3)))
               if (lagged) then
                  call shear_resistance(element%shear, past%force(1), maxval(abs(past%force(2:3))), resistance, by)
                  by = 0.0_wp
               else
                  call shear_resistance(element%shear, q(1), abs(q(end)), resistance, by)
               end if
               call back_stress(element%shear, state%slip, past%damage, back, by_slip)
               resisted = dot_product(a, q) - back
               if (slides .and. (state%slip - past%slip) * sense < 0.0_wp) then   ! it does not slide that way
                  slides = .false.
                  missing = missing + a * (state%slip - past%slip)
                  state%slip = past%slip
                  done = .false.
               else if (.not. slides .and. iteration > 1 .and. abs(resisted) > resistance + scale(1)) then
                  slides = .true.
                  sense = sign(1.0_wp, resisted)
               end if
            else
               slides = .false.
            end if
            if (slides) then
               gradient = a
               gradient(1) = gradient(1) - sense * by(1)
               gradient(end) = gradient(end) - sense * by(2) * sign(1.0_wp, q(end))
               reach = max(reach, abs(resisted - sense * resistance) / scale(1))
            end if
            call bordered(flexible, merge(a, 0.0_wp, slides), gradient, merge(-by_slip, 0.0_wp, slides), missing, &
               merge(sense * resistance - resisted, 0.0_wp, slides), slides, change, stiffness, status)
            if (status /= status_ok) return
            status = status_too_many_steps
            missing = missing / [section%length, 1.0_wp, 1.0_wp]
            if (done .and. reach <= 1.0_wp .and. iteration > 1 .and. &
               maxval(abs(change(1:3)) / scale) <= 1.0_wp .and. maxval(abs(missing)) < 1.0e-9_wp) then
               status = status_ok
               exit
            end if
            do i = 1, n
               step(:, i) = loose(:, i) + matmul(own(:, :, i), change(1:3))
            end do
            ! Energy along the step: its slope at the end must not exceed that at the start
            over = 1.0_wp
            if (iteration > 1) then
               slope0 = 0.0_wp
               do i = 1, n
                  b(1, :) = [1.0_wp, 0.0_wp, 0.0_wp]
                  b(2, :) = [0.0_wp, 1.0_wp - place(i), -place(i)]
                  call section_forces(section, state%strain(:, i), past%crushed(i), s, k)
                  slope0 = slope0 + weight(i) * dot_product(s - heavy(:, i) - matmul(b, q + change(1:3)), &
                     step(:, i))
               end do
               do halving = 1, 8
                  slope1 = 0.0_wp
                  do i = 1, n
                     b(1, :) = [1.0_wp, 0.0_wp, 0.0_wp]
                     b(2, :) = [0.0_wp, 1.0_wp - place(i), -place(i)]
                     trial = state%strain(:, i) + over * step(:, i)
                     call section_forces(section, trial, past%crushed(i), s, k)
                     slope1 = slope1 + weight(i) * dot_product(s - heavy(:, i) - matmul(b, q + change(1:3)), &
                        step(:, i))
                  end do
                  if (slope1 <= 0.7_wp * abs(slope0)) exit
                  over = over * max(0.1_wp, min(0.6_wp, slope0 / (slope0 - slope1)))
               end do
            end if
            q = q + over * change(1:3)
            state%strain(:, 1:n) = state%strain(:, 1:n) + over * step(:, 1:n)
            state%slip = state%slip + over * change(4)
         end do
         if (status /= status_ok) return
         state%state = past%state
         call note_state(element, state, slides, resistance)
      end associate
   end subroutine pier_forces

   !> Solve F x + a s = missing with g x + c s = rest where it slides, and give dq/dv
   pure subroutine bordered(flexible, a, g, c, missing, rest, slides, x, stiffness, status)
      real(wp), intent(in) :: flexible(3, 3)
      real(wp), intent(in) :: a(3)
      real(wp), intent(in) :: g(3)
      real(wp), intent(in) :: c
      real(wp), intent(in) :: missing(3)
      real(wp), intent(in) :: rest
      logical, intent(in) :: slides
      real(wp), intent(out) :: x(4)
      real(wp), intent(out) :: stiffness(3, 3)
      integer(c_int), intent(out) :: status
      real(wp) :: inverse(3, 3), minor(3, 3), determinant, pivot, along(3)
      integer :: i, j
      x = 0.0_wp
      stiffness = 0.0_wp
      status = status_singular
      do j = 1, 3
         do i = 1, 3
            associate (p => 1 + mod(i, 3), r => 1 + mod(i + 1, 3), m => 1 + mod(j, 3), k => 1 + mod(j + 1, 3))
               minor(i, j) = flexible(p, m) * flexible(r, k) - flexible(p, k) * flexible(r, m)
            end associate
         end do
      end do
      determinant = dot_product(flexible(1, :), minor(1, :))
      if (.not. abs(determinant) > 0.0_wp .or. abs(determinant) > huge(1.0_wp)) return
      inverse = transpose(minor) / determinant
      x(1:3) = matmul(inverse, missing)
      stiffness = inverse
      status = status_ok
      if (.not. slides) return
      along = matmul(inverse, a)
      pivot = c - dot_product(g, along)
      if (.not. abs(pivot) > 0.0_wp) then
         status = status_singular
         return
      end if
      x(4) = (rest - dot_product(g, x(1:3))) / pivot
      x(1:3) = x(1:3) - along * x(4)
      along = along / pivot
      do j = 1, 3
         stiffness(:, j) = stiffness(:, j) + along * dot_product(g, inverse(:, j))
      end do
   end subroutine bordered

   !> How far a pier has come
   pure subroutine note_state(element, state, slides, resistance)
      type(macro_element), intent(in) :: element
      type(element_state), intent(inout) :: state
      logical, intent(in) :: slides
      real(wp), intent(in) :: resistance
      real(wp) :: most, greatest
      associate (section => element%section, n => state%force(1))
         greatest = maxval(abs(state%force(2:3)))
         most = 0.5_wp * n * (section%length - n / (section%strength * section%thickness))
         if (greatest > abs(n) * section%length / 6.0_wp) state%state = max(state%state, frame_state_cracked)
         if (greatest >= at_strength * most) state%state = max(state%state, frame_state_flexure)
         if (slides .and. resistance < huge(1.0_wp)) state%state = max(state%state, frame_state_shear)
      end associate
   end subroutine note_state

   !> Forces and tangent of a beam between plastic hinges of one strength
   pure subroutine beam_forces(element, past, v, state, stiffness)
      type(macro_element), intent(in) :: element
      type(element_state), intent(in) :: past
      real(wp), intent(in) :: v(3)
      type(element_state), intent(inout) :: state
      real(wp), intent(out) :: stiffness(3, 3)
      real(wp) :: flexible(2, 2), k(2, 2), m(2), trial(2), over, strength
      logical :: yields(2)
      integer :: i, j
      strength = past%left * element%moment
      associate (h => element%length, stiff => element%inertia_stiffness)
         flexible = h / (6.0_wp * stiff) * reshape([2.0_wp, -1.0_wp, -1.0_wp, 2.0_wp], [2, 2]) &
            + 1.0_wp / (element%shear_stiffness * h**2)
         over = flexible(1, 1)**2 - flexible(1, 2)**2
         k = reshape([flexible(1, 1), -flexible(1, 2), -flexible(1, 2), flexible(1, 1)] / over, [2, 2])
         trial = matmul(k, v(2:3) - past%hinge)
         m = trial
         yields = .false.
         if (any(abs(trial) > strength)) then
            i = merge(1, 2, abs(trial(1)) >= abs(trial(2)))
            j = 3 - i
            yields(i) = .true.
            m(i) = sign(strength, trial(i))
            m(j) = trial(j) + k(j, i) / k(i, i) * (m(i) - trial(i))
            if (abs(m(j)) > strength) then
               yields(j) = .true.
               m(j) = sign(strength, m(j))
            end if
         end if
         state%hinge = v(2:3) - matmul(flexible, m)
         stiffness = 0.0_wp
         stiffness(1, 1) = element%axial_stiffness / h
         if (.not. any(yields)) then
            stiffness(2:3, 2:3) = k
         else if (.not. all(yields)) then
            stiffness(j + 1, j + 1) = 1.0_wp / flexible(j, j)
         end if
         state%force = [stiffness(1, 1) * v(1), m]
         state%state = past%state
         if (any(yields)) state%state = max(state%state, merge(frame_state_shear, frame_state_flexure, &
            element%hinge_by_shear))
      end associate
   end subroutine beam_forces

   !> Forces of a pier beyond a drift limit: the shear force fades, pressure is still carried.
   !>
   !> A moment that is constant along the pier needs no shear: it stays elastic until N acts near the edge.
   pure subroutine failed_forces(element, v, state, stiffness)
      type(macro_element), intent(in) :: element
      real(wp), intent(in) :: v(3)
      type(element_state), intent(inout) :: state
      real(wp), intent(out) :: stiffness(3, 3)
      real(wp), parameter :: edge = 0.45_wp   !! eccentricity that N can have, over the length of the section
      real(wp) :: axial, bending, normal, moment, arm
      stiffness = 0.0_wp
      associate (section => element%section)
         axial = section%young * section%length * section%thickness / element%length
         bending = axial * section%length**2 / 12.0_wp
         arm = edge * section%length
      end associate
      normal = state%failed(1) + axial * (v(1) - state%failed(2))
      if (normal < 0.0_wp) then
         axial = element%section%residual * axial
         normal = element%section%residual * normal
      end if
      stiffness(1, 1) = axial
      moment = state%failed(4) + bending * (v(3) - v(2) - state%failed(5))
      if (abs(moment) <= arm * max(normal, 0.0_wp)) then
         stiffness(2:3, 2) = [bending, -bending]
         stiffness(2:3, 3) = [-bending, bending]
      else
         arm = sign(arm, moment)
         moment = arm * max(normal, 0.0_wp)
         if (normal > 0.0_wp) stiffness(2:3, 1) = axial * [-arm, arm]
      end if
      state%force = [normal, state%left * state%failed(3) - moment, state%left * state%failed(3) + moment]
   end subroutine failed_forces

   !> Keep what a step in equilibrium has made of an element
   pure subroutine element_committed(element, state)
      type(macro_element), intent(in) :: element
      type(element_state), intent(inout) :: state
      integer :: i
      if (.not. element%pier .or. state%state >= frame_state_failed_flexure) return
      do i = 1, element%sections
         state%crushed(i) = crushed_further(element%section, state%strain(:, i), state%crushed(i))
      end do
      state%damage = max(state%damage, damage_at(element%shear, state%slip))
   end subroutine element_committed

   !> Whether a committed element has just reached a drift limit: then its moments begin to fade
   pure subroutine element_failed(element, state, failed)
      type(macro_element), intent(in) :: element
      type(element_state), intent(inout) :: state
      logical, intent(out) :: failed
      real(wp) :: drift
      failed = .false.
      if (state%state >= frame_state_failed_flexure) return
      drift = maxval(abs(state%deformation(2:3)))
      if (state%state == frame_state_shear .and. drift >= element%drift(2)) then
         state%state = frame_state_failed_shear
      else if (drift >= element%drift(1)) then
         state%state = frame_state_failed_flexure
      else
         return
      end if
      failed = .true.
      associate (q => state%force, v => state%deformation)
         state%failed = [q(1), v(1), 0.5_wp * (q(2) + q(3)), 0.5_wp * (q(3) - q(2)), v(3) - v(2)]
      end associate
      state%left = 1.0_wp
   end subroutine element_failed

end module frame_element
