!> Steps of blocks of the plane without springs, see dem_rigid.
module dem_moreau
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use dem_bodies, only : body
   use dem_contacts, only : contact_pair, overlap, measure_overlap, choose_edges
   use dem_law, only : point_force, point_frame, frame_of, hand_over, find_relative_velocity
   use dem_model, only : block_model, predict_velocity, prepare_step, pull_ties
   use dem_rigid, only : bear_mortar, gives_way, find_reversal, has_mortar, mortar_fails, number_bodies, parting, &
      solve_step, steady
   use nonsmooth_impulses, only : along_normal, along_tangent, find_point_rate, impulse_problem, in_plane, &
      problem_room
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: number_unknowns, solve_contacts, greatest_speed

   real(wp), parameter :: closed_angle = 1.0e-4_wp !! at which a joint is closed [rad]

contains

   !> Greatest speed of a body [m/s]
   pure function greatest_speed(model) result(speed)
      type(block_model), intent(in) :: model
      real(wp) :: speed
      integer :: k
      speed = 0.0_wp
      do k = 1, size(model%set%item)
         associate (b => model%set%item(k))
            if (.not. b%fixed) speed = max(speed, abs(b%vx) + abs(b%vy) + b%radius * abs(b%spin))
         end associate
      end do
   end function greatest_speed

   !> Order of the unknowns and room for the contact points, after a search
   subroutine number_unknowns(model, status)
      type(block_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer, allocatable :: bodies(:, :)
      logical, allocatable :: fixed(:)              ! as it stands in the bodies it would be copied, unchecked
      integer :: k, failed

      status = status_out_of_memory
      associate (rigid => model%rigid, pairs => model%contacts%pairs)
         if (.not. allocated(model%ahead)) then
            allocate (model%ahead(5, size(model%set%item)), stat=failed)
            if (failed /= 0) return
         end if
         if (allocated(model%number)) deallocate (model%number)
         allocate (model%number(2, pairs), bodies(2, pairs), fixed(size(model%set%item)), stat=failed)
         if (failed /= 0) return
         do k = 1, size(fixed)
            fixed(k) = model%set%item(k)%fixed
         end do
         do k = 1, pairs
            bodies(:, k) = model%contacts%pair(k)%bodies
         end do
         call number_bodies(rigid, in_plane, fixed, bodies, status)
         if (status == status_ok) call problem_room(rigid%problem, 2 * pairs, pairs, status)
         if (status /= status_ok) return
         do k = 1, size(model%set%item)
            if (rigid%node(k) == 0) cycle
            associate (b => model%set%item(k), at => 3 * rigid%node(k))
               rigid%problem%mass(at - 2:at) = [b%mass, b%mass, b%inertia]
            end associate
         end do
      end associate
   end subroutine number_unknowns

   !> Forces of all contacts in the next step, added to the bodies
   subroutine solve_contacts(model, status)
      type(block_model), intent(inout) :: model
      integer(c_int), intent(out) :: status         !! not_finite where a velocity is no number, else ok
      integer :: k

      call prepare_step(model)
      if (model%quasi_static) then
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (b%fixed) cycle
               b%vx = 0.0_wp
               b%vy = 0.0_wp
               b%spin = 0.0_wp
            end associate
         end do
      end if
      associate (rigid => model%rigid, problem => model%rigid%problem)
         do k = 1, size(model%set%item)
            call predict_velocity(model, model%set%item(k))
         end do
         call pull_ties(model)
         do k = 1, size(model%set%item)
            associate (b => model%set%item(k))
               if (b%fixed) then
                  model%ahead(:, k) = led_to(b, model%step, [b%px, b%py, b%pspin])
                  cycle
               end if
               model%ahead(:, k) = led_to(b, model%step, [b%vx, b%vy, b%spin])
               problem%rate(3 * rigid%node(k) - 2:3 * rigid%node(k)) = [b%vx, b%vy, b%spin]
               b%px = b%vx + model%kick * (b%fx * b%inverse_mass + model%pull(1))
               b%py = b%vy + model%kick * (b%fy * b%inverse_mass + model%pull(2))
               b%pspin = b%spin + model%kick * b%moment * b%inverse_inertia
               problem%free(3 * rigid%node(k) - 2:3 * rigid%node(k)) = [b%px, b%py, b%pspin]
            end associate
         end do
         problem%points = 0
         do k = 1, model%contacts%pairs
            call gather_points(model, k)
         end do
         call solve_step(rigid, model%model_clock, status)
         do k = 1, model%contacts%pairs
            call apply_impulses(model, model%contacts%pair(k), model%number(:, k))
         end do
      end associate
   end subroutine solve_contacts

   !> Place to which a velocity leads: x, y, rotation, its cosine and sine
   pure function led_to(b, step, rate) result(at)
      type(body), intent(in) :: b
      real(wp), intent(in) :: step                  !! [s]
      real(wp), intent(in) :: rate(3)               !! [m/s, m/s, rad/s]
      real(wp) :: at(5)
      at(1:3) = [b%x, b%y, b%angle] + step * rate
      at(4:5) = [cos(at(3)), sin(at(3))]
   end function led_to

   !> The points of a pair that may press in this step, into the problem
   subroutine gather_points(model, k)
      type(block_model), intent(inout) :: model
      integer, intent(in) :: k
      type(overlap) :: now, next
      type(body) :: a_next, b_next
      type(point_frame) :: frame
      real(wp) :: distance, u_n, u_t, still_n, still_t
      integer :: i, n, side
      logical :: bonded

      associate (pair => model%contacts%pair(k), rigid => model%rigid, problem => model%rigid%problem)
         model%number(:, k) = 0
         if (pair%careful) call choose_edges(model%set, model%contacts%skin, pair, distance)
         associate (a => model%set%item(pair%bodies(1)), b => model%set%item(pair%bodies(2)))
            call measure_overlap(pair, a, b, now)
            pair%point%meets = now%meets
            if (now%width <= 0.0_wp) return
            call place_body(model%ahead(:, pair%bodies(1)), a_next)
            call place_body(model%ahead(:, pair%bodies(2)), b_next)
            call measure_overlap(pair, a_next, b_next, next)
            do i = 1, 2
               if (min(now%gap(i), next%gap(i)) > model%contacts%skin) cycle
               frame = frame_of(now, i, a, b)
               n = problem%points + 1
               problem%points = n
               model%number(i, k) = n
               problem%node(:, n) = rigid%node(pair%bodies)
               problem%row(:, 1, along_normal, n) = [-frame%nx, -frame%ny, -frame%a_n]
               problem%row(:, 2, along_normal, n) = [frame%nx, frame%ny, frame%b_n]
               problem%row(:, 1, along_tangent, n) = [-frame%tx, -frame%ty, -frame%a_t]
               problem%row(:, 2, along_tangent, n) = [frame%tx, frame%ty, frame%b_t]
               bonded = pair%point(i)%bonded .and. has_mortar(model%law(pair%law))
               ! Parting velocity over the last step, where supports move as in the next one
               u_n = 0.0_wp
               u_t = 0.0_wp
               still_n = 0.0_wp
               still_t = 0.0_wp
               do side = 1, 2
                  associate (c => model%set%item(pair%bodies(side)), row => problem%row(:, side, :, n))
                     if (c%fixed) then
                        still_n = still_n + sum(row(:, 1) * [c%px, c%py, c%pspin])
                        still_t = still_t + sum(row(:, 2) * [c%px, c%py, c%pspin])
                     else
                        u_n = u_n + sum(row(:, 1) * [c%vx, c%vy, c%spin])
                     end if
                  end associate
               end do
               problem%shift(along_normal, n) = still_n &
                  + parting(rigid, model%step, now%gap(i), next%gap(i), u_n + still_n, bonded)
               problem%shift(along_tangent, n) = still_t
               problem%friction(n) = model%law(pair%law)%friction
               call bear_mortar(rigid, model%law(pair%law), n, merge(0.5_wp * now%width * model%kick, 0.0_wp, bonded))
               problem%impulse(:, n) = model%kick * [pair%point(i)%spring_n, pair%point(i)%spring_s]
               if (.not. abs(pair%point(i)%late) > 0.0_wp) cycle
               do side = 1, 2
                  associate (at => 3 * problem%node(side, n))
                     if (at > 0) problem%free(at - 2:at) = problem%free(at - 2:at) &
                        + pair%point(i)%late * problem%row(:, side, along_tangent, n) / problem%mass(at - 2:at)
                  end associate
               end do
            end do
            call share_friction(pair, now, model%number(:, k), problem)
         end associate
      end associate
   end subroutine gather_points

   !> The two points of a closed joint lie on the line of its shear force: both slide alike, to the last digit
   pure subroutine share_friction(pair, now, point, problem)
      type(contact_pair), intent(in) :: pair
      type(overlap), intent(in) :: now
      integer, intent(in) :: point(2)
      type(impulse_problem), intent(inout) :: problem
      if (any(point == 0) .or. abs(now%gap(2) - now%gap(1)) > closed_angle * pair%incident_length) return
      problem%row(:, :, along_tangent, point(2)) = problem%row(:, :, along_tangent, point(1))
      problem%shift(along_tangent, point(2)) = problem%shift(along_tangent, point(1))
   end subroutine share_friction

   !> A body at another place, for `measure`
   pure subroutine place_body(at, b)
      real(wp), intent(in) :: at(5)                 !! x, y, rotation, its cosine and sine
      type(body), intent(out) :: b
      b%x = at(1)
      b%y = at(2)
      b%angle = at(3)
      b%c = at(4)
      b%s = at(5)
   end subroutine place_body

   !> The impulses of a pair as forces on its bodies, and what they took
   subroutine apply_impulses(model, pair, point)
      type(block_model), intent(inout) :: model
      type(contact_pair), intent(inout) :: pair
      integer, intent(in) :: point(2)               !! numbers of its points in the problem, 0 where they cannot press
      type(overlap) :: now
      type(point_frame) :: frame
      type(point_force) :: force
      real(wp) :: u_n, u_t, late(2)
      integer :: i

      associate (problem => model%rigid%problem)
         associate (a => model%set%item(pair%bodies(1)), b => model%set%item(pair%bodies(2)))
            call measure_overlap(pair, a, b, now)
            late = find_late(model, pair, point)
            do i = 1, 2
               force = point_force()
               if (point(i) > 0) then
                  force%normal = problem%impulse(along_normal, point(i)) / model%kick
                  force%shear = (problem%impulse(along_tangent, point(i)) + pair%point(i)%late) / model%kick
               end if
               pair%point(i)%late = late(i)
               if (pair%point(i)%bonded) pair%point(i)%bonded = point(i) > 0
               if (pair%point(i)%bonded) pair%point(i)%bonded = .not. mortar_fails(model%rigid, model%model_clock, point(i))
               associate (was => pair%point(i))
                  if (.not. (was%closed .or. max(abs(force%normal), abs(force%shear)) > 0.0_wp)) cycle
                  frame = frame_of(now, i, a, b)
                  call find_relative_velocity(frame, b%vx - a%vx, b%vy - a%vy, a%spin, b%spin, u_n, u_t)
                  was%damping_loss = was%damping_loss - 0.5_wp * model%drift * (was%spring_n + force%normal) * u_n
                  was%friction_loss = was%friction_loss - 0.5_wp * model%drift * (was%spring_s + force%shear) * u_t
                  call hand_over(model%kick, model%drift, frame, was, force, a, b, pair%support_work)
                  was%spring_n = force%normal
                  was%spring_s = force%shear
                  was%closed = max(abs(force%normal), abs(force%shear)) > 0.0_wp
               end associate
            end do
         end associate
      end associate
   end subroutine apply_impulses

   !> Shear impulses that are due to the points of a pair in the next step, as sliding has reversed; keeps the sliding velocities
   function find_late(model, pair, point) result(late)
      type(block_model), intent(in) :: model
      type(contact_pair), intent(inout) :: pair
      integer, intent(in) :: point(2)               !! in the problem, 0: it cannot press
      real(wp) :: late(2)
      real(wp) :: w(3), old(2), older(2), held, bound, share
      logical :: turns(2), reverses
      integer :: i
      late = 0.0_wp
      held = 0.0_wp
      bound = 0.0_wp
      do i = 1, 2
         old(i) = pair%point(i)%slip(1)
         older(i) = pair%point(i)%slip(2)
         w = 0.0_wp
         if (.not. is_held(model, point(i)) .and. point(i) > 0) w = find_point_rate(model%rigid%problem, point(i))
         pair%point(i)%slip = [w(along_tangent), merge(old(i), 0.0_wp, w(along_tangent) * old(i) > 0.0_wp)]
         turns(i) = point(i) > 0 .and. abs(old(i)) > 0.0_wp .and. w(along_tangent) * old(i) <= 0.0_wp &
            .and. .not. pair%point(i)%bonded
         if (.not. turns(i)) cycle
         associate (p => model%rigid%problem%impulse(:, point(i)))
            turns(i) = abs(p(along_normal) - model%kick * pair%point(i)%spring_n) &
               < steady * p(along_normal)
            if (.not. turns(i)) cycle
            held = held + sign(p(along_tangent), old(i) * p(along_tangent))
            bound = bound + model%rigid%problem%friction(point(i)) * p(along_normal)
         end associate
      end do
      do i = 1, 2
         if (.not. turns(i)) cycle
         associate (p => model%rigid%problem%impulse(:, point(i)))
            call find_reversal(sign(1.0_wp, old(i)) * older(i), abs(old(i)), held, bound, reverses, share)
            if (reverses) late(i) = sign(1.0_wp, old(i)) * share * model%rigid%problem%friction(point(i)) &
               * p(along_normal) - p(along_tangent)
         end associate
      end do
   end function find_late

   !> Whether mortar holds a point in this step
   pure function is_held(model, point) result(held)
      type(block_model), intent(in) :: model
      integer, intent(in) :: point                  !! in the problem, 0: it cannot press
      logical :: held
      held = point > 0
      if (held) held = .not. gives_way(model%rigid, model%model_clock, point)
   end function is_held

end module dem_moreau
